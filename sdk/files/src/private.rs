//! Folders and files that only this user can write to or read.

use std::fs::{DirBuilder, File, Metadata};
use std::io;
use std::path::Path;

/// Creates a folder for this user alone, or checks that an existing one is this user's and not
/// writable by others.
///
/// # Errors
/// When the folder cannot be created, belongs to another user, or is writable by others.
pub fn folder(path: &Path) -> io::Result<()> {
    make_folder(path)?;
    check(&File::open(path)?.metadata()?, 0o022)
}

/// Creates a folder for this user alone, and those above it; one that is there stays as it is.
///
/// # Errors
/// Those of the system.
pub fn make_folder(path: &Path) -> io::Result<()> {
    let mut builder = DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)
}

/// Creates a folder for this user alone.
///
/// # Errors
/// Those of the system, also when there is something in its place.
pub(crate) fn create_folder(path: &Path) -> io::Result<()> {
    #[cfg_attr(not(unix), allow(unused_mut))] // Only Unix has modes.
    let mut builder = DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)
}

/// Takes from others what they may do with a folder of this user.
///
/// # Errors
/// Those of the system.
#[cfg(unix)]
pub fn close(folder: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(folder, std::fs::Permissions::from_mode(0o700))
}

/// Elsewhere, folders in the user's home inherit its permissions.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub fn close(_: &Path) -> io::Result<()> {
    Ok(())
}

/// Makes that only this user may read and write what is created.
pub fn only_user(options: &mut std::fs::OpenOptions) -> &mut std::fs::OpenOptions {
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(options, 0o600);
    options
}

/// Opens a file that others may neither read nor write.
///
/// # Errors
/// When the file cannot be opened, belongs to another user, or is readable or writable by others.
pub fn file(path: &Path) -> io::Result<File> {
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
