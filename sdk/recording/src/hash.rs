//! The hash of a recording's bytes, by which provenance tells recordings of one name apart.

use std::fs::{File, Metadata};
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The file that a recording was read from, as far as its hash needs it.
///
/// A file is hashed where provenance asks for it, and not when it is read, which would read it
/// twice for a tenth of the time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordedFile(Known);

#[derive(Debug, Clone, PartialEq, Default)]
enum Known {
    /// The recording is of no file, or of one that is read once, such as a pipe.
    #[default]
    Nothing,
    Hash(String),
    File(PathBuf, Version),
}

impl RecordedFile {
    /// The file at a path as it is now.
    pub(crate) fn at(path: &Path) -> Self {
        let known = || {
            let version = Version::of(path)?;
            Some(Known::File(std::path::absolute(path).ok()?, version))
        };
        Self(known().unwrap_or_default())
    }

    /// A file that is in memory.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(Known::Hash(blake3::hash(bytes).to_hex().to_string()))
    }

    /// BLAKE3 of the file's bytes, 64 hexadecimal digits. `None` where there is no file, and where
    /// the file is another one than at the reading, or cannot be read any more.
    pub fn blake3(&self) -> Option<String> {
        match &self.0 {
            Known::Nothing => None,
            Known::Hash(hash) => Some(hash.clone()),
            Known::File(path, version) => of_file(path, *version).ok().flatten(),
        }
    }
}

/// What tells that a file has not changed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Version {
    bytes: u64,
    modified: Option<SystemTime>,
}

impl Version {
    /// `None` of what is no regular file, such as a pipe, which is read once.
    fn of(path: &Path) -> Option<Self> {
        let metadata = std::fs::metadata(path).ok()?;
        metadata.is_file().then(|| Self::of_metadata(&metadata))
    }

    fn of_metadata(metadata: &Metadata) -> Self {
        Self { bytes: metadata.len(), modified: metadata.modified().ok() }
    }
}

/// BLAKE3 of a file that is still of this version, hexadecimal; `None` of one that changed.
fn of_file(path: &Path, version: Version) -> io::Result<Option<String>> {
    let file = File::open(path)?;
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(&file)?;
    let is_same = Version::of_metadata(&file.metadata()?) == version;
    Ok(is_same.then(|| hasher.finalize().to_hex().to_string()))
}
