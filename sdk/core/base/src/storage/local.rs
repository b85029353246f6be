//! Local files.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use crate::storage::{Stat, StorageError, StorageProblem};

pub(crate) fn read(path: &Path, most_bytes: u64) -> Result<Vec<u8>, StorageError> {
    let mut bytes = Vec::new();
    let file = opened(path)?;
    let taken = file
        .take(most_bytes.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(StorageError::io_at(path.display()))?;
    check(path, taken as u64, most_bytes)?;
    Ok(bytes)
}

pub(crate) fn copy(path: &Path, mut into: File, most_bytes: u64) -> Result<(), StorageError> {
    let mut from = opened(path)?.take(most_bytes.saturating_add(1));
    let copied = io::copy(&mut from, &mut into).map_err(StorageError::io_at(path.display()))?;
    check(path, copied, most_bytes)
}

pub(crate) fn stat(path: &Path) -> Result<Option<Stat>, StorageError> {
    match path.metadata() {
        Ok(is) => Ok(is.is_file().then_some(Stat {
            bytes: is.len(),
            etag: None,
            modified: is.modified().ok(),
        })),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(StorageProblem::Io { error }.at_place(path.display())),
    }
}

#[allow(clippy::disallowed_methods, reason = "the user named this file")]
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), StorageError> {
    crate::files::write_file(path, bytes).map_err(StorageError::io_at(path.display()))
}

#[allow(clippy::disallowed_methods, reason = "the user named this file")]
pub(crate) fn remove(path: &Path) -> Result<(), StorageError> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(StorageProblem::Io { error }.at_place(path.display()))
        }
        _ => Ok(()),
    }
}

#[allow(clippy::disallowed_methods, reason = "the user named this file")]
pub(crate) fn write_copy(path: &Path, of: &Path) -> Result<(), StorageError> {
    let mut from = opened(of)?;
    crate::files::replace_file(path, |into| io::copy(&mut from, into).map(drop))
        .map_err(StorageError::io_at(path.display()))
}

pub(crate) fn opened(path: &Path) -> Result<File, StorageError> {
    File::open(path).map_err(StorageError::io_at(path.display()))
}

fn check(path: &Path, bytes: u64, most_bytes: u64) -> Result<(), StorageError> {
    if bytes <= most_bytes {
        Ok(())
    } else {
        Err(StorageProblem::TooLarge { most_bytes }.at_place(path.display()))
    }
}
