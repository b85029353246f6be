//! Reads files whose names come from untrusted files, such as recipes, tables, scenes, or the JSON
//! next to a recording.
//!
//! Such a name may lead to a pipe that never ends, to a device, or to a file that fills the memory.
//! Programs therefore read all such files with this module, which reads only regular files, and
//! only up to a size limit. Programs do not use this module for a file that the user names as an
//! argument, because such a file may be a pipe.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, Read};
use std::path::Path;

/// Opens a regular file. Follows links, and does not wait for the writer of a pipe.
///
/// # Errors
/// Returns an error if there is no such file, if it is a folder, a pipe, a socket or a device, or
/// if the system reports an error.
pub fn open_regular(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true);
    without_waiting(&mut options);
    // The file is opened first, and then the open file is checked, so that the path cannot change
    // in between.
    let file = options.open(path)?;
    check_regular(&file.metadata()?)?;
    Ok(file)
}

/// Checks that a path leads to a regular file.
///
/// # Errors
/// Returns the errors of [`open_regular`] that can be detected without opening the file.
pub fn check_regular_at(path: &Path) -> io::Result<()> {
    check_regular(&path.metadata()?)
}

/// Reads a regular file of at most `most_bytes`.
///
/// # Errors
/// Returns the errors of [`open_regular`], and an error if the file is larger.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let file = folder.path().join("recipe.toml");
/// std::fs::write(&file, "[library]")?;
/// assert_eq!(htex_base::files::read_regular(&file, 9)?, b"[library]");
/// assert!(htex_base::files::read_regular(&file, 8).is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read_regular(path: &Path, most_bytes: u64) -> io::Result<Vec<u8>> {
    let file = open_regular(path)?;
    let too_long = || {
        let words = format!("it has more than {most_bytes} bytes, which is the most here");
        io::Error::new(io::ErrorKind::FileTooLarge, words)
    };
    // Refused before it is read. The second check is for files that grow, and for kernel files that
    // state a length of 0.
    if file.metadata()?.len() > most_bytes {
        return Err(too_long());
    }
    let mut bytes = Vec::new();
    file.take(most_bytes.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes { Err(too_long()) } else { Ok(bytes) }
}

/// Reads a regular file of UTF-8 text, as [`read_regular`] does.
///
/// # Errors
/// Returns the errors of [`read_regular`], and an error if the file is not UTF-8.
pub fn read_regular_text(path: &Path, most_bytes: u64) -> io::Result<String> {
    String::from_utf8(read_regular(path, most_bytes)?)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is not UTF-8 text"))
}

fn check_regular(is: &Metadata) -> io::Result<()> {
    if is.is_file() {
        return Ok(());
    }
    let words = if is.is_dir() {
        "it is a folder; name a file"
    } else {
        "it is a pipe or a device; only regular files are read here"
    };
    Err(io::Error::new(io::ErrorKind::InvalidInput, words))
}

#[cfg(unix)]
fn without_waiting(options: &mut OpenOptions) {
    use std::os::unix::fs::OpenOptionsExt;
    // The flags have the same bits as the argument of `open`, which is an `int`.
    let flags = rustix::fs::OFlags::NONBLOCK | rustix::fs::OFlags::NOCTTY;
    options.custom_flags(flags.bits().cast_signed());
}

#[cfg(not(unix))]
fn without_waiting(_: &mut OpenOptions) {}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_regular_file_is_refused_without_waiting() -> Result<(), Box<dyn std::error::Error>>
    {
        let folder = tempfile::tempdir()?;
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status()?.success());
        for path in [&pipe, Path::new("/dev/zero"), folder.path()] {
            assert!(read_regular(path, 10).is_err(), "{}", path.display());
            assert!(open_regular(path).is_err() && check_regular_at(path).is_err());
        }
        // A kernel file claims to be regular and empty, but never ends.
        assert!(read_regular("/proc/self/environ".as_ref(), 1).is_err());
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        std::fs::write(&file, "abc")?;
        std::os::unix::fs::symlink(&file, &link)?;
        assert_eq!(read_regular_text(&link, 3)?, "abc");
        Ok(())
    }
}
