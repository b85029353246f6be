//! Files that are whole or not there: written beside their place, and renamed into it.
//!
//! A symbolic link is followed, and what it leads to is replaced, with the mode that it had. What is no file (a device,
//! a pipe) is written to and stays what it is. A process that is asked to end removes what it did not finish by
//! [`remove_unfinished`].
#![forbid(unsafe_code)]

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::NamedTempFile;

/// Files that are being written.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Removes the files that this process is writing: for a handler of signals, before the process ends. None of them
/// gets its name any more.
pub fn remove_unfinished() {
    let unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
    for path in unfinished.iter() {
        let _ = std::fs::remove_file(path);
    }
    std::mem::forget(unfinished);
}

fn unfinished<T>(run: impl FnOnce(&mut BTreeSet<PathBuf>) -> T) -> T {
    run(&mut UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner))
}

/// A file that is being written. Dropped before [`Self::keep`] it leaves nothing behind, but for what went to a pipe or
/// device.
#[derive(Debug)]
pub struct Unfinished(Kind);

#[derive(Debug)]
enum Kind {
    /// A file beside its place, and the place.
    Beside(NamedTempFile, PathBuf),
    /// What is no file, open.
    Direct(File),
}

impl Unfinished {
    /// Begins a file that is to be at `path`.
    ///
    /// # Errors
    /// When `path` is a folder or a link that leads nowhere, its folder is not there, or the system refuses.
    pub fn create(path: &Path) -> io::Result<Self> {
        let path = followed(path)?;
        let there = path.metadata().ok();
        if there.as_ref().is_some_and(std::fs::Metadata::is_dir) {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        if there.as_ref().is_some_and(|is| !is.is_file()) {
            let direct = OpenOptions::new().write(true).open(&path)?;
            return Ok(Self(Kind::Direct(direct)));
        }
        let folder = folder(&path);
        if !folder.is_dir() {
            return Err(io::Error::new(
                io::ErrorKind::NotFound,
                "its folder is not there; make it first",
            ));
        }
        let beside = builder().tempfile_in(folder)?;
        if let Some(there) = there {
            beside.as_file().set_permissions(there.permissions())?;
        }
        unfinished(|all| all.insert(beside.path().to_owned()));
        Ok(Self(Kind::Beside(beside, path)))
    }

    /// The file to write to.
    pub fn file(&mut self) -> &mut File {
        match &mut self.0 {
            Kind::Beside(beside, _) => beside.as_file_mut(),
            Kind::Direct(file) => file,
        }
    }

    /// Puts all on the disk and gives the file its name: a reader sees the old file or the new one, never a part, and so
    /// does one after a crash.
    ///
    /// # Errors
    /// What the system reports; the place is then as it was.
    pub fn keep(mut self) -> io::Result<()> {
        self.file().flush()?;
        let Kind::Beside(beside, path) = &mut self.0 else {
            return Ok(());
        };
        beside.as_file().sync_all()?;
        // Renamed while the set is held: whoever ends the process meanwhile has removed it, or finds it finished.
        unfinished(|all| {
            std::fs::rename(beside.path(), &*path)?;
            all.remove(beside.path());
            Ok::<(), io::Error>(())
        })?;
        beside.disable_cleanup(true);
        sync_folder(folder(path))
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if let Kind::Beside(beside, _) = &self.0 {
            unfinished(|all| all.remove(beside.path()));
        }
    }
}

/// Writes a file beside `path` and renames it over `path` once `write` has succeeded.
///
/// # Errors
/// Whatever `write` or the system reports; `path` is then as it was.
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> io::Result<()> {
    let mut unfinished = Unfinished::create(path)?;
    write(unfinished.file())?;
    unfinished.keep()
}

/// [`replace_file`] with bytes that stand ready.
///
/// # Errors
/// As [`replace_file`].
pub fn write_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace_file(path, |file| file.write_all(bytes))
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// What a symbolic link leads to; any other path as it is.
fn followed(path: &Path) -> io::Result<PathBuf> {
    match path.symlink_metadata() {
        Ok(is) if is.is_symlink() => path.canonicalize().map_err(|error| {
            let words = format!("it is a symbolic link that leads nowhere ({error})");
            io::Error::new(error.kind(), words)
        }),
        _ => Ok(path.to_owned()),
    }
}

/// A temporary file with the permissions of an ordinary one: all may read and write, less the
/// process's mask.
fn builder() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".htex-").suffix(".part");
    if let Some(permissions) = ordinary() {
        builder.permissions(permissions);
    }
    builder
}

#[cfg(unix)]
fn ordinary() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn ordinary() -> Option<Permissions> {
    None
}

/// Puts the rename itself on the disk.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() -> Outcome {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("a.htex");
        write_file(&path, b"old")?;
        let failed = replace_file(&path, |file| {
            file.write_all(b"half of the ne")?;
            Err(io::Error::other("killed"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&path)?, b"old");
        assert_eq!(fs::read_dir(folder.path())?.count(), 1);
        Ok(())
    }

    #[test]
    fn the_target_stays_whole_until_the_writer_is_done() -> Outcome {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("a.htex");
        write_file(&path, b"old")?;
        replace_file(&path, |file| {
            file.write_all(b"new")?;
            file.sync_all()?;
            assert_eq!(fs::read(&path)?, b"old");
            Ok(())
        })?;
        assert_eq!(fs::read(&path)?, b"new");
        Ok(())
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_an_ordinary_file() -> Outcome {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir()?;
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write_file(&ours, b"x")?;
        fs::write(&plain, b"x")?;
        let mode = |p: &Path| fs::metadata(p).map(|m| m.permissions().mode());
        assert_eq!(mode(&ours)?, mode(&plain)?);
        Ok(())
    }

    /// A link is followed, a mode is kept, and what is no file stays what it is.
    #[cfg(unix)]
    #[test]
    fn what_is_there_stays_what_it_is() -> Outcome {
        use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
        let folder = tempfile::tempdir()?;
        let at = |name: &str| folder.path().join(name);
        fs::write(at("secret"), b"old")?;
        fs::set_permissions(at("secret"), Permissions::from_mode(0o600))?;
        symlink("secret", at("link"))?;
        write_file(&at("link"), b"new")?;
        assert!(at("link").symlink_metadata()?.is_symlink());
        assert_eq!(fs::read(at("secret"))?, b"new");
        assert_eq!(
            fs::metadata(at("secret"))?.permissions().mode() & 0o777,
            0o600
        );
        symlink("nothing", at("lost"))?;
        assert!(write_file(&at("lost"), b"x").is_err());
        assert!(!at("nothing").exists());
        let pipe = at("pipe");
        assert!(
            std::process::Command::new("mkfifo")
                .arg(&pipe)
                .status()?
                .success()
        );
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe)
        });
        write_file(&pipe, b"through")?;
        assert_eq!(reader.join().map_err(|_| "the reader failed")??, b"through");
        assert!(pipe.metadata()?.file_type().is_fifo());
        write_file(Path::new("/dev/null"), b"gone")?;
        assert!(fs::metadata("/dev/null")?.file_type().is_char_device());
        assert!(write_file(folder.path(), b"x").is_err());
        Ok(())
    }
}
