//! Folders and files that only this user can write to or read.

use std::fs::{DirBuilder, File, Metadata};
use std::io;
use std::path::Path;

/// Creates a folder for this user alone, or checks that an existing one is this user's and not writable by others.
///
/// # Errors
/// When the folder cannot be created, belongs to another user, or is writable by others.
pub(super) fn folder(path: &Path) -> io::Result<()> {
    let mut builder = DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)?;
    check(&File::open(path)?.metadata()?, 0o022)
}

/// Opens a file that others may neither read nor write.
///
/// # Errors
/// When the file cannot be opened, belongs to another user, or is readable or writable by others.
pub(super) fn file(path: &Path) -> io::Result<File> {
    let file = File::open(path)?;
    check(&file.metadata()?, 0o077)?;
    Ok(file)
}

/// Refuses a file of another user, and one with any of the permissions `others`.
#[cfg(unix)]
fn check(opened: &Metadata, others: u32) -> io::Result<()> {
    use std::os::unix::fs::MetadataExt;
    let own = opened.uid() == rustix::process::geteuid().as_raw();
    if own && opened.mode() & others == 0 {
        Ok(())
    } else {
        Err(io::ErrorKind::PermissionDenied.into())
    }
}

/// Elsewhere, folders in the user's home inherit its permissions.
#[cfg(not(unix))]
fn check(_: &Metadata, _: u32) -> io::Result<()> {
    Ok(())
}
