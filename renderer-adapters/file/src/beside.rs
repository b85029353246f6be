//! A file that is whole or not there.

use std::fs::{File, Permissions};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

/// A file beside its place. Dropped, it is gone; [`Self::keep`] renames it into its place.
pub(crate) struct Beside {
    file: NamedTempFile,
    path: PathBuf,
}

impl Beside {
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        if path.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        if !folder.is_dir() {
            return Err(io::Error::other("its folder is not there; make it first"));
        }
        let mut builder = Builder::new();
        builder.prefix(".htex-").suffix(".part");
        if let Some(permissions) = ordinary() {
            builder.permissions(permissions);
        }
        Ok(Self {
            file: builder.tempfile_in(folder)?,
            path: path.to_owned(),
        })
    }

    /// A second handle to write through.
    pub(crate) fn writer(&self) -> io::Result<File> {
        self.file.as_file().try_clone()
    }

    /// Puts all on the disk and gives the file its name.
    pub(crate) fn keep(self) -> io::Result<()> {
        self.file.as_file().sync_all()?;
        self.file
            .persist(&self.path)
            .map_err(|failed| failed.error)?;
        Ok(())
    }
}

/// The permissions of an ordinary file: all may read and write, less the process's mask.
#[cfg(unix)]
fn ordinary() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn ordinary() -> Option<Permissions> {
    None
}
