//! Reads byte ranges that all come from the same version of a file.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::storage::cloud::{Store, Version};
use crate::storage::{Location, StorageError, StorageProblem, local};

/// The number of requests and bytes that the program has needed so far to read a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Usage {
    /// Number of requests that were sent, including retries; for a local file, the number of reads.
    pub requests: u64,
    /// Number of bytes received.
    pub bytes: u64,
}

/// An open file, from which ranges of one version are read. If the file is replaced, reads fail
/// with [`StorageProblem::Changed`] and never mix two versions.
///
/// ```
/// use htex_base::storage::{Location, Storage};
///
/// let folder = tempfile::tempdir()?;
/// let location = Location::from(folder.path().join("library"));
/// let storage = Storage::from_environment()?;
/// storage.write(&location, b"0123456789")?;
/// let file = storage.open(&location, 4)?;
/// let mut buffer = [0; 3];
/// file.read_at(6, &mut buffer)?;
/// assert_eq!((file.len(), &buffer), (10, b"678"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Remote {
    location: Location,
    of: Content,
    len: u64,
    etag: Option<String>,
    /// The bytes that the first request returned. A second field has the offset of the first byte.
    head: Vec<u8>,
    head_start: u64,
}

/// Largest file that is read as a whole if the server sends no ranges, bytes.
const MOST_WHOLE_BYTES: u64 = 1 << 20;

enum Content {
    File { file: Mutex<File>, requests: AtomicU64, bytes: AtomicU64 },
    Store { store: Box<Store>, version: Version },
}

impl Remote {
    pub(crate) fn of_store(
        location: &Location,
        store: Store,
        head: Range<u64>,
    ) -> Result<Self, StorageError> {
        let head_start = head.start;
        let part = match store.part(head, None) {
            Err(error) if matches!(error.problem, StorageProblem::NoRanges) && head_start == 0 => {
                return Self::of_whole(location, store, error);
            }
            part => part?,
        };
        Ok(Self {
            location: location.clone(),
            len: part.version.bytes,
            etag: part.version.etag.clone(),
            head: part.bytes,
            head_start,
            of: Content::Store { store: Box::new(store), version: part.version },
        })
    }

    /// Reads a small file as a whole, from a server that sends no ranges.
    fn of_whole(
        location: &Location,
        store: Store,
        no_ranges: StorageError,
    ) -> Result<Self, StorageError> {
        let head = match store.read(MOST_WHOLE_BYTES) {
            Err(error) if matches!(error.problem, StorageProblem::TooLarge { .. }) => {
                return Err(no_ranges);
            }
            whole => whole?,
        };
        let len = head.len() as u64;
        Ok(Self {
            location: location.clone(),
            of: Content::Store { store: Box::new(store), version: Version::unknown(len) },
            len,
            etag: None,
            head,
            head_start: 0,
        })
    }

    pub(crate) fn of_file(
        location: &Location,
        path: &Path,
        head: Range<u64>,
    ) -> Result<Self, StorageError> {
        let file = local::opened(path)?;
        let len = file.metadata().map_err(StorageError::io_at(path.display()))?.len();
        let mut remote = Self {
            location: location.clone(),
            of: Content::File {
                file: Mutex::new(file),
                requests: AtomicU64::new(0),
                bytes: AtomicU64::new(0),
            },
            len,
            etag: None,
            head: Vec::new(),
            head_start: head.start,
        };
        // A store cuts a range off at the end of the file, so local files do too.
        let end = head.end.min(len);
        if head.start < end {
            remote.head = remote.fetch(head.start..end)?;
        }
        Ok(remote)
    }

    /// Returns the size of the file, bytes.
    pub fn len(&self) -> u64 {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Returns the entity tag of the version that is read, if the store has one.
    pub fn etag(&self) -> Option<&str> {
        self.etag.as_deref()
    }

    /// Returns the number of requests and bytes so far, including the request that opened the file.
    pub fn usage(&self) -> Usage {
        let (requests, bytes) = match &self.of {
            Content::Store { store, .. } => store.usage(),
            Content::File { requests, bytes, .. } => {
                (requests.load(Ordering::Relaxed), bytes.load(Ordering::Relaxed))
            }
        };
        Usage { requests, bytes }
    }

    /// Fills the buffer with the bytes that start at `offset`. Sends one request, or no request if
    /// the first request already returned these bytes.
    ///
    /// # Errors
    /// Returns an error if the range ends after the end of the file, or if the file was replaced or
    /// cannot be read.
    pub fn read_at(&self, offset: u64, buffer: &mut [u8]) -> Result<(), StorageError> {
        let end = offset.saturating_add(buffer.len() as u64);
        if end > self.len {
            return Err(self.out_of_range(offset..end));
        }
        if buffer.is_empty() {
            return Ok(());
        }
        match self.in_head(offset, buffer.len()) {
            Some(bytes) => buffer.copy_from_slice(bytes),
            None => buffer.copy_from_slice(&self.fetch(offset..end)?),
        }
        Ok(())
    }

    fn in_head(&self, offset: u64, len: usize) -> Option<&[u8]> {
        let from = usize::try_from(offset.checked_sub(self.head_start)?).ok()?;
        self.head.get(from..)?.get(..len)
    }

    /// Returns exactly the bytes of a range within the file.
    fn fetch(&self, range: Range<u64>) -> Result<Vec<u8>, StorageError> {
        let wanted = range.end - range.start;
        let found = match &self.of {
            Content::Store { store, version } => store.part(range, Some(version.clone()))?.bytes,
            Content::File { file, requests, bytes } => {
                let read =
                    read_file(&mut file.lock().unwrap_or_else(PoisonError::into_inner), &range);
                let read = read.map_err(StorageError::io_at(&self.location))?;
                requests.fetch_add(1, Ordering::Relaxed);
                bytes.fetch_add(read.len() as u64, Ordering::Relaxed);
                read
            }
        };
        // The range was inside the file when it was opened, so a shorter answer means that it was
        // replaced.
        if found.len() as u64 == wanted {
            Ok(found)
        } else {
            Err(StorageProblem::Changed.at_place(&self.location))
        }
    }

    pub(crate) fn head(&self) -> &[u8] {
        &self.head
    }

    pub(crate) fn into_head(self) -> Vec<u8> {
        self.head
    }

    pub(crate) fn out_of_range(&self, range: Range<u64>) -> StorageError {
        let (offset, end, len) = (range.start, range.end, self.len);
        StorageProblem::Range { offset, end, len }.at_place(&self.location)
    }
}

fn read_file(file: &mut File, range: &Range<u64>) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.seek(SeekFrom::Start(range.start))?;
    file.take(range.end - range.start).read_to_end(&mut bytes)?;
    Ok(bytes)
}

impl std::fmt::Debug for Remote {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({} bytes)", self.location, self.len)
    }
}
