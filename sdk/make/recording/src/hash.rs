//! The hash of a recording's file. An asset's provenance stores this hash, to distinguish
//! recordings with the same name.

use std::fs::{File, Metadata};
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The file from which a recording was read, with the data that is needed to compute the file's
/// hash.
///
/// The hash is computed only when an asset's provenance needs it. To compute the hash, the file
/// must be read a second time. If every recording were hashed, reading would take a tenth longer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordedFile(FileIdentity);

#[derive(Debug, Clone, PartialEq, Default)]
enum FileIdentity {
    /// The recording does not come from a file, or it comes from a file that can be read only once,
    /// such as a pipe.
    #[default]
    Nothing,
    Hash(String),
    File(PathBuf, Version),
}

impl RecordedFile {
    /// The file at a path, in its present version.
    pub(crate) fn of_path(path: &Path) -> Self {
        let known = || {
            let version = Version::read(path)?;
            Some(FileIdentity::File(std::path::absolute(path).ok()?, version))
        };
        Self(known().unwrap_or_default())
    }

    /// A file whose bytes are in memory.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(FileIdentity::Hash(blake3::hash(bytes).to_hex().to_string()))
    }

    /// BLAKE3 of the file's bytes, 64 hexadecimal digits. `None` if there is no file, if the file
    /// has changed since it was read, or if it can no longer be read.
    pub fn blake3(&self) -> Option<String> {
        match &self.0 {
            FileIdentity::Nothing => None,
            FileIdentity::Hash(hash) => Some(hash.clone()),
            FileIdentity::File(path, version) => of_file(path, *version).ok().flatten(),
        }
    }
}

/// Size and time of modification, which show whether a file has changed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Version {
    bytes: u64,
    modified: Option<SystemTime>,
}

impl Version {
    /// `None` if the path is not a regular file. For example, a pipe can be read only once.
    fn read(path: &Path) -> Option<Self> {
        let metadata = std::fs::metadata(path).ok()?;
        metadata.is_file().then(|| Self::of_metadata(&metadata))
    }

    fn of_metadata(metadata: &Metadata) -> Self {
        Self { bytes: metadata.len(), modified: metadata.modified().ok() }
    }
}

/// BLAKE3 of a file, hexadecimal; `None` if the file is no longer of this version.
fn of_file(path: &Path, version: Version) -> io::Result<Option<String>> {
    let file = File::open(path)?;
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(&file)?;
    let is_same = Version::of_metadata(&file.metadata()?) == version;
    Ok(is_same.then(|| hasher.finalize().to_hex().to_string()))
}
