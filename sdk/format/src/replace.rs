//! Files that are whole or not there.

use std::fs::{File, Permissions};
use std::io::{self, Write};
use std::path::Path;

/// Writes a file beside `path` and renames it over `path` once `write` has succeeded and all is on
/// the disk. A reader sees the old file or the new one, never a part; so does one after a crash.
///
/// # Errors
/// Whatever `write` or the system reports; `path` is then as it was.
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut beside = builder().tempfile_in(folder)?;
    write(beside.as_file_mut())?;
    beside.as_file_mut().flush()?;
    beside.as_file().sync_all()?;
    beside.persist(path).map_err(|failed| failed.error)?;
    sync_folder(folder)
}

/// [`replace_file`] with bytes that stand ready.
///
/// # Errors
/// As [`replace_file`].
pub fn write_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace_file(path, |file| file.write_all(bytes))
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
}
