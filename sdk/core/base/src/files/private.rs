//! Private folders, to which only this user can write, and private files, which no other user can
//! read or write.

use std::fs::{DirBuilder, File, Metadata};
use std::io;
use std::path::Path;

/// Creates a folder for this user only, or checks that an existing folder belongs to this user and
/// is not writable by others.
///
/// # Errors
/// Returns an error if the folder cannot be created, belongs to another user, or is writable by
/// others.
pub fn folder(path: &Path) -> io::Result<()> {
    make_folder(path)?;
    // Others may read the folder: each file in it is private by its own permissions.
    check(&File::open(path)?.metadata()?, 0o022)
}

/// Creates a folder for this user only, and the missing folders above it. Does not change an
/// existing folder.
///
/// # Errors
/// Errors of the system.
pub fn make_folder(path: &Path) -> io::Result<()> {
    let mut builder = DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)
}

/// Creates a folder for this user only.
///
/// # Errors
/// Errors of the system, including an error if a file or folder of this name exists.
pub(crate) fn create_folder(path: &Path) -> io::Result<()> {
    #[cfg_attr(not(unix), allow(unused_mut))] // Only Unix has modes.
    let mut builder = DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)
}

/// Removes all permissions of other users from a folder of this user.
///
/// # Errors
/// Errors of the system.
#[cfg(unix)]
pub fn close(folder: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(folder, std::fs::Permissions::from_mode(0o700))
}

/// Does nothing. On systems other than Unix, a folder in the user's home folder inherits the
/// permissions of the home folder.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub fn close(_: &Path) -> io::Result<()> {
    Ok(())
}

/// Sets options so that they create files which only this user can read and write.
pub fn only_user(options: &mut std::fs::OpenOptions) -> &mut std::fs::OpenOptions {
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(options, 0o600);
    options
}

/// Opens a private file, which others may neither read nor write.
///
/// # Errors
/// Returns an error if the file cannot be opened, belongs to another user, or is readable or
/// writable by others.
pub fn file(path: &Path) -> io::Result<File> {
    let file = File::open(path)?;
    check(&file.metadata()?, 0o077)?;
    Ok(file)
}

/// Refuses a file that belongs to another user or that has any of the permissions `others`.
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

/// Does nothing. On systems other than Unix, a folder in the user's home folder inherits the
/// permissions of the home folder.
#[cfg(not(unix))]
fn check(_: &Metadata, _: u32) -> io::Result<()> {
    Ok(())
}
