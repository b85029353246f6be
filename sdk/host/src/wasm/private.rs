//! Folders and files that are this user's alone.

use std::fs::{DirBuilder, File, Metadata};
use std::io;
use std::path::Path;

/// Makes a folder for this user alone, or takes one that is this user's and that nobody else may write to.
///
/// # Errors
/// When it cannot be made, or is another's.
pub(super) fn folder(path: &Path) -> io::Result<()> {
    let mut builder = DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)?;
    check(&File::open(path)?.metadata()?, 0o022)
}

/// Opens a file for this user to read, which nobody else may read or write.
///
/// # Errors
/// When it cannot be opened, or is another's.
pub(super) fn file(path: &Path) -> io::Result<File> {
    let file = File::open(path)?;
    check(&file.metadata()?, 0o077)?;
    Ok(file)
}

/// Refuses what is another user's, or lets others do more than it may.
#[cfg(unix)]
fn check(opened: &Metadata, others: u32) -> io::Result<()> {
    use std::os::unix::fs::MetadataExt;
    let own = opened.uid() == rustix::process::geteuid().as_raw();
    match own && opened.mode() & others == 0 {
        true => Ok(()),
        false => Err(io::ErrorKind::PermissionDenied.into()),
    }
}

/// The user's own folders are the user's alone by inheritance.
#[cfg(not(unix))]
fn check(_: &Metadata, _: u32) -> io::Result<()> {
    Ok(())
}
