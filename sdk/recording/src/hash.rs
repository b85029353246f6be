//! The hash of a recording's bytes, by which provenance tells recordings of one name apart.

use std::fs::{File, Metadata};
use std::io;
use std::path::Path;
use std::time::SystemTime;

/// BLAKE3 of bytes, hexadecimal.
pub(crate) fn of_bytes(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// What tells that a file has not changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Version {
    bytes: u64,
    modified: Option<SystemTime>,
}

impl Version {
    /// `None` of what is no regular file, such as a pipe, which is read once.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let metadata = std::fs::metadata(path).ok()?;
        metadata.is_file().then(|| Self::of_metadata(&metadata))
    }

    fn of_metadata(metadata: &Metadata) -> Self {
        Self {
            bytes: metadata.len(),
            modified: metadata.modified().ok(),
        }
    }
}

/// BLAKE3 of a file that is still of this version, hexadecimal; `None` of one that changed.
pub(crate) fn of_file(path: &Path, version: Version) -> io::Result<Option<String>> {
    let file = File::open(path)?;
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(&file)?;
    let is_same = Version::of_metadata(&file.metadata()?) == version;
    Ok(is_same.then(|| hasher.finalize().to_hex().to_string()))
}
