//! Hashes of files. Builds reuse a stored hash as long as the file's size and times stay the same.

use std::collections::BTreeMap;
use std::fs::Metadata;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use htex_base::files::{AtFile, FileError, check_regular_at, open_regular};
use serde::{Deserialize, Serialize};

use crate::BuildError;
use crate::remote::{RemoteFiles, is_remote, remote_location};
use crate::state::StateFolder;

/// If a file changes within this time before it is hashed, a later change may leave its time the
/// same, because file systems store times in steps of up to 2 s (FAT).
const RACY: Duration = Duration::from_secs(2);

/// Largest size of a build's stored hashes, bytes: a few million files.
const MOST_BYTES: u64 = 1 << 30;

/// Largest size of a file that a recipe names, bytes: the largest recording that is read.
const MOST_FILE_BYTES: u64 = 4 << 30;

/// Size and times of a file. A build compares them to notice a change without reading the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    pub bytes: u64,
    /// Time of the last change of the contents, nanoseconds since 1970; 0 for a remote file that
    /// has a version.
    modified_ns: u64,
    /// Number of the file on its file system, or 0 if it has none. For a remote file, its version.
    number: u64,
}

impl Stamp {
    /// Returns the stamp of a remote file. Its version is its entity tag, or else the time of its
    /// last change. Without both, the time lies in the far future, so that the file's hash is never
    /// stored for the next build.
    pub(crate) fn remote(bytes: u64, etag: Option<&str>, modified: Option<SystemTime>) -> Self {
        let version = |etag: &str| {
            let hash = blake3::hash(etag.as_bytes());
            let first = hash.as_bytes().first_chunk().copied();
            u64::from_le_bytes(first.unwrap_or_default())
        };
        Self {
            bytes,
            modified_ns: match (etag, modified) {
                (Some(_), _) => 0,
                (None, Some(time)) => {
                    nanoseconds(time.duration_since(UNIX_EPOCH).unwrap_or_default())
                }
                (None, None) => u64::MAX,
            },
            number: etag.map_or(0, version),
        }
    }

    /// Returns the stamp of a local file: its size and times.
    ///
    /// # Errors
    /// Returns errors of the system. Also returns an error if the system does not state when the
    /// file changed.
    pub fn read(file: &Path) -> io::Result<Self> {
        Self::of_metadata(&file.metadata()?)
    }

    fn of_metadata(metadata: &Metadata) -> io::Result<Self> {
        let since = metadata.modified()?.duration_since(UNIX_EPOCH);
        Ok(Self {
            bytes: metadata.len(),
            modified_ns: nanoseconds(since.unwrap_or_default()),
            number: number(metadata),
        })
    }
}

/// Returns nanoseconds as `u64`, which suffices until the year 2554.
fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(unix)]
fn number(metadata: &Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::ino(metadata)
}

#[cfg(not(unix))]
fn number(_: &Metadata) -> u64 {
    0
}

/// Hash of a file's contents, with the file's stamp at the time of hashing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileHash {
    /// BLAKE3 of the contents, hexadecimal.
    pub blake3: String,
    /// Size and times of the file.
    pub stamp: Stamp,
}

/// Known hashes by path.
#[derive(Debug)]
pub(crate) struct Hashes {
    known: BTreeMap<PathBuf, FileHash>,
    remote: Arc<RemoteFiles>,
    /// Hashes of the files in this build.
    used: Mutex<BTreeMap<PathBuf, FileHash>>,
}

impl Hashes {
    /// Reads the hashes that an earlier build stored. If the file with the hashes is missing or
    /// damaged, starts without hashes.
    pub(crate) fn open(kept: &StateFolder, name: &str, remote: Arc<RemoteFiles>) -> Self {
        let known =
            kept.get(name, MOST_BYTES).and_then(|bytes| serde_json::from_slice(&bytes).ok());
        Self { known: known.unwrap_or_default(), remote, used: Mutex::default() }
    }

    /// Starts without hashes of an earlier build.
    pub(crate) fn new(remote: Arc<RemoteFiles>) -> Self {
        Self { known: BTreeMap::new(), remote, used: Mutex::default() }
    }

    /// Checks that a file exists and is a regular file, without reading it.
    pub(crate) fn check(&self, path: &Path) -> Result<(), BuildError> {
        self.stamp(path).map(drop)
    }

    /// Returns whether the hash of a file is known without reading it.
    pub(crate) fn is_known(&self, path: &Path) -> bool {
        let known = self.known.get(path).map(|hashed| hashed.stamp);
        known.is_some() && known == self.stamp(path).ok()
    }

    /// Adds hashes of files. They are valid as long as the stamps of the files stay the same.
    pub(crate) fn add(&self, hashed: impl IntoIterator<Item = (PathBuf, FileHash)>) {
        let mut used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        // The new hashes come last, because they replace the earlier ones.
        used.extend(self.known.clone());
        used.extend(hashed);
    }

    /// Returns the hash of a file. Reads the file only if it has changed since it was last hashed.
    pub(crate) fn hash(&self, path: &Path) -> Result<FileHash, BuildError> {
        let used = |hashes: &Mutex<BTreeMap<PathBuf, FileHash>>| {
            let used = hashes.lock().unwrap_or_else(PoisonError::into_inner);
            used.get(path).cloned()
        };
        if let Some(hashed) = used(&self.used) {
            return Ok(hashed);
        }
        let stamp = self.stamp(path)?;
        let hashed = match self.known.get(path) {
            Some(hashed) if hashed.stamp == stamp => hashed.clone(),
            _ => hash(path, &self.remote)?,
        };
        let mut used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        used.insert(path.to_owned(), hashed.clone());
        Ok(hashed)
    }

    fn stamp(&self, path: &Path) -> Result<Stamp, BuildError> {
        match remote_location(path)? {
            Some(location) => Ok(self.remote.stamp(path, &location)?),
            None => {
                // A recipe may name a pipe or a device, which must not be read.
                check_regular_at(path).reading(path)?;
                let stamp = Stamp::read(path).reading(path)?;
                if stamp.bytes > MOST_FILE_BYTES {
                    return Err(FileError::reading(path, too_large(stamp.bytes)).into());
                }
                Ok(stamp)
            }
        }
    }

    /// Returns the hashes to store for the next build, as JSON. Files that have changed just now
    /// are left out. URLs with a query are left out because the query may contain a signature.
    pub(crate) fn to_keep(&self) -> Vec<u8> {
        let used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let settled = |(path, hashed): &(&PathBuf, &FileHash)| {
            let racy_until = hashed.stamp.modified_ns.saturating_add(nanoseconds(RACY));
            let has_query = is_remote(path) && path.to_string_lossy().contains('?');
            racy_until < nanoseconds(now) && !has_query
        };
        let kept: BTreeMap<&PathBuf, &FileHash> = used.iter().filter(settled).collect();
        serde_json::to_vec(&kept).unwrap_or_default()
    }
}

/// Hashes a local or remote file.
pub(crate) fn hash(path: &Path, copies: &RemoteFiles) -> Result<FileHash, BuildError> {
    match remote_location(path)? {
        Some(location) => copies.hash(path, &location),
        None => Ok(hash_local(path).reading(path)?),
    }
}

/// Hashes a file. It must not change in the meantime.
pub(crate) fn hash_local(path: &Path) -> io::Result<FileHash> {
    let mut file = open_regular(path)?;
    let before = Stamp::of_metadata(&file.metadata()?)?;
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(&mut file)?;
    // The stamp is read from the path and not from the open file, so that a replaced file is also
    // noticed.
    if Stamp::read(path)? != before {
        return Err(changed());
    }
    Ok(FileHash { blake3: hasher.finalize().to_hex().to_string(), stamp: before })
}

fn too_large(bytes: u64) -> io::Error {
    io::Error::new(
        io::ErrorKind::FileTooLarge,
        format!("it has {bytes} bytes and the most is {MOST_FILE_BYTES}"),
    )
}

pub(crate) fn changed() -> io::Error {
    io::Error::other("it changed while it was read; start again when it is complete")
}
