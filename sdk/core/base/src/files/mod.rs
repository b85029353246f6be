//! Reads and writes files safely, including untrusted files and folders.
//!
//! - An untrusted file, such as a recipe, may name another file. The program reads the named file
//!   only if it is a regular file, and only up to a size limit ([`read_regular`]).
//! - A program that writes to an untrusted folder does not follow links in this folder
//!   ([`OwnFolder`]).
//! - Data that a program stores in such a folder is authenticated (`Key`).
//! - Files are written atomically: a file is first written under a temporary name and then renamed
//!   to its target. So readers see either the old file or the complete new file.
//!
//! If the path of an output file is a symbolic link, the program replaces the link's target and
//! keeps the permissions of the old target. If the output is a device or a pipe, the program writes
//! to it directly, without a temporary file. A process that receives a signal to end removes its
//! unfinished files with [`remove_unfinished`]. The next process that writes to a folder removes
//! the unfinished files that killed processes left in this folder.
//!
//! ```
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("numbers.txt");
//! htex_base::files::write_file(&path, b"1 2 3")?;
//! assert_eq!(std::fs::read(&path)?, b"1 2 3");
//! # Ok::<(), std::io::Error>(())
//! ```
#![forbid(unsafe_code)]

mod batch;
mod error;
#[cfg(feature = "key")]
mod key;
mod killed;
mod lines;
mod own_folder;
pub mod private;
mod regular;
#[cfg(feature = "toml")]
pub mod toml;

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::NamedTempFile;

pub use batch::Batch;
pub use error::{AtFile, FileError, FileProblem};
#[cfg(feature = "key")]
pub use key::{Key, random_key};
pub use lines::bounded_lines;
pub use own_folder::OwnFolder;
pub use regular::{check_regular_at, open_regular, read_regular, read_regular_text};

/// Files that this process is writing.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Removes the files that this process is writing. A signal handler calls this function before the
/// process ends. After the call, no unfinished file can be completed.
pub fn remove_unfinished() {
    let unfinished = UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner);
    for path in unfinished.iter() {
        let _ = std::fs::remove_file(path);
    }
    // The lock stays taken for ever, so that no other thread can rename a file after its removal.
    std::mem::forget(unfinished);
}

fn unfinished<T>(run: impl FnOnce(&mut BTreeSet<PathBuf>) -> T) -> T {
    run(&mut UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner))
}

/// A file that is being written. If this value is dropped before [`Self::keep`], the file is
/// removed. Data that was written to a pipe or a device cannot be removed.
#[derive(Debug)]
pub struct FileInProgress(Target);

#[derive(Debug)]
enum Target {
    /// A temporary file next to the target, and the path of the target.
    Beside(NamedTempFile, PathBuf),
    /// An open pipe or device.
    Direct(File),
}

impl Target {
    fn new(path: &Path) -> io::Result<Self> {
        let path = followed(path)?;
        let there = path.metadata().ok();
        if there.as_ref().is_some_and(std::fs::Metadata::is_dir) {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        if there.as_ref().is_some_and(|is| !is.is_file()) {
            let direct = OpenOptions::new().write(true).open(&path)?;
            return Ok(Self::Direct(direct));
        }
        let folder = folder(&path);
        if !folder.is_dir() {
            return Err(io::Error::new(
                io::ErrorKind::NotFound,
                "its folder does not exist; create it first",
            ));
        }
        Self::beside(path, there, Readers::All)
    }

    /// Creates a temporary file for `path`. It will replace a link at `path` and not follow it.
    fn in_place_of(path: PathBuf, readable_by: Readers) -> io::Result<Self> {
        let there = path.symlink_metadata().ok();
        if there.as_ref().is_some_and(std::fs::Metadata::is_dir) {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        let there = there.filter(std::fs::Metadata::is_file);
        Self::beside(path, there, readable_by)
    }

    /// Creates a temporary file next to `path`, with the permissions of an existing file.
    fn beside(
        path: PathBuf,
        there: Option<std::fs::Metadata>,
        readable_by: Readers,
    ) -> io::Result<Self> {
        let beside = builder(readable_by).tempfile_in(folder(&path))?;
        // The owner is taken from the new file, because on some file systems it is not the user of
        // the process.
        killed::remove_from(folder(&path), &beside.as_file().metadata()?);
        if let Some(there) = there {
            beside.as_file().set_permissions(there.permissions())?;
        }
        unfinished(|all| all.insert(beside.path().to_owned()));
        Ok(Self::Beside(beside, path))
    }
}

impl FileInProgress {
    /// Creates the temporary file for the target `path`.
    ///
    /// # Errors
    /// Returns an error if `path` is a folder or a dangling link, its folder does not exist, or the
    /// system reports an error.
    pub fn create(path: &Path) -> io::Result<Self> {
        Target::new(path).map(Self)
    }

    /// Creates the temporary file for `path`. It will replace a link at `path` and not follow it.
    fn in_place_of(path: PathBuf, readable_by: Readers) -> io::Result<Self> {
        Target::in_place_of(path, readable_by).map(Self)
    }

    /// Returns the file to write to.
    pub fn file(&mut self) -> &mut File {
        match &mut self.0 {
            Target::Beside(beside, _) => beside.as_file_mut(),
            Target::Direct(file) => file,
        }
    }

    /// Flushes the file to disk and renames it to its target. A reader sees either the old file or
    /// the complete new file, even after a crash.
    ///
    /// # Errors
    /// Errors of the system. After an error, the target is unchanged.
    pub fn keep(mut self) -> io::Result<()> {
        self.file().flush()?;
        let Target::Beside(beside, path) = &mut self.0 else {
            return Ok(());
        };
        beside.as_file().sync_all()?;
        // The file is renamed while the set is locked. So a signal handler that ends the process
        // either removed the file before, or finds it complete.
        unfinished(|all| {
            std::fs::rename(beside.path(), &*path)?;
            all.remove(beside.path());
            Ok::<(), io::Error>(())
        })?;
        beside.disable_cleanup(true);
        sync_folder(folder(path))
    }
}

impl Drop for FileInProgress {
    fn drop(&mut self) {
        if let Target::Beside(beside, _) = &self.0 {
            unfinished(|all| all.remove(beside.path()));
        }
    }
}

/// A temporary file for intermediate data that does not fit into memory. Programs use it while they
/// write another file. The temporary file is removed when this value is dropped.
#[derive(Debug)]
pub struct Scratch(NamedTempFile);

impl Scratch {
    /// Creates a file in the folder of `path`, so that it is on the same file system as the result.
    /// If `path` is a pipe or a device, the file is created in the system's folder for temporary
    /// files.
    ///
    /// # Errors
    /// Returns an error if the folder does not exist, or the system reports an error.
    pub fn beside(path: &Path) -> io::Result<Self> {
        let path = followed(path)?;
        let is_special = path.metadata().is_ok_and(|is| !is.is_file());
        let file = if is_special {
            builder(Readers::All).tempfile()?
        } else {
            builder(Readers::All).tempfile_in(folder(&path))?
        };
        unfinished(|all| all.insert(file.path().to_owned()));
        Ok(Self(file))
    }

    /// Returns the file to write to and to read from.
    pub fn file(&mut self) -> &mut File {
        self.0.as_file_mut()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        unfinished(|all| all.remove(self.0.path()));
    }
}

/// Writes a file atomically. `write` writes to a temporary file in the folder of `path`. If `write`
/// succeeds, the temporary file is renamed to `path`.
///
/// # Errors
/// Returns errors of `write` and of the system. After an error, the file at `path` is unchanged.
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> io::Result<()> {
    let mut unfinished = FileInProgress::create(path)?;
    write(unfinished.file())?;
    unfinished.keep()
}

/// Writes bytes to a file atomically, as [`replace_file`] does.
///
/// # Errors
/// Returns the errors of [`replace_file`].
pub fn write_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace_file(path, |file| file.write_all(bytes))
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Returns the target of a symbolic link. Returns any other path unchanged.
fn followed(path: &Path) -> io::Result<PathBuf> {
    match path.symlink_metadata() {
        Ok(is) if is.is_symlink() => path.canonicalize().map_err(|error| {
            let words = format!("it is a symbolic link to a missing file ({error})");
            io::Error::new(error.kind(), words)
        }),
        _ => Ok(path.to_owned()),
    }
}

/// The users who may read a new file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Readers {
    /// Everyone, except where the process's umask forbids it.
    All,
    /// Only this user.
    User,
}

/// Returns a builder of temporary files. With [`Readers::All`], they get the permissions of an
/// ordinary file: readable and writable by all, limited by the process's umask. With
/// [`Readers::User`], only this user may read and write them.
fn builder(readable_by: Readers) -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(&killed::OWN[..]).suffix(killed::ENDING);
    if readable_by == Readers::All
        && let Some(permissions) = ordinary()
    {
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

/// Flushes the rename to disk.
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
    fn scratch_is_removed_and_keeps_what_is_written() -> Outcome {
        use std::io::{Read, Seek};
        let folder = tempfile::tempdir()?;
        let mut scratch = Scratch::beside(&folder.path().join("a.htexlib"))?;
        scratch.file().write_all(b"kept aside")?;
        scratch.file().rewind()?;
        let mut read = String::new();
        scratch.file().read_to_string(&mut read)?;
        assert_eq!(read, "kept aside");
        assert_eq!(fs::read_dir(folder.path())?.count(), 1);
        drop(scratch);
        assert_eq!(fs::read_dir(folder.path())?.count(), 0);
        Scratch::beside(Path::new("/dev/null"))?;
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

    /// A link is followed, permissions stay the same, and pipes and devices are written to
    /// directly.
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
        assert_eq!(fs::metadata(at("secret"))?.permissions().mode() & 0o777, 0o600);
        symlink("nothing", at("lost"))?;
        assert!(write_file(&at("lost"), b"x").is_err());
        assert!(!at("nothing").exists());
        let pipe = at("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status()?.success());
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
