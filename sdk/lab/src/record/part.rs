//! The part file, which stores a take while it is recorded. The program only appends to this file,
//! and flushes it to disk every second.
//!
//! The first line is the header as JSON. After this line, the file contains chunks. A chunk
//! consists of one byte for its kind, the number of data bytes (u32), the data as f64 values, and a
//! hash. The hash is the first eight bytes of the BLAKE3 hash of the preceding parts of the chunk.
//! All numbers are little-endian. A crash may leave an incomplete or damaged chunk. A reader
//! ignores the first such chunk and everything after it.

use std::fs::{File, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, FileError, OwnFolder};

use crate::error::LabError;
use crate::record::data::{TakeData, TakeHeader};
use crate::record::files;

/// Kind of a chunk that contains frames.
const FRAMES: u8 = b'F';
/// Kind of a chunk that contains rows of the tracker.
const TRACKER: u8 = b'T';
/// Length of a chunk's hash, bytes.
const HASH: usize = 8;
/// Longest header, bytes.
const MOST_HEADER: usize = 1 << 20;

/// An open part file. It stays locked until it is dropped.
#[derive(Debug)]
pub struct PartFile {
    path: PathBuf,
    file: File,
    frames: Vec<f64>,
    rows: Vec<f64>,
    waiting: usize,
    /// Number of values (frames times signals) in one second.
    second: usize,
}

impl PartFile {
    /// Creates a part file, which must not exist yet.
    ///
    /// # Errors
    /// [`LabError::File`].
    pub fn create(path: &Path, header: &TakeHeader) -> Result<Self, LabError> {
        let begun = || -> std::io::Result<File> {
            let (folder, name) = OwnFolder::of_file(path)?;
            let mut file = OwnFolder::private(folder.path()).create(&name)?;
            // The file is locked before the header is written, because `recover` removes a file
            // without a complete header.
            file.try_lock().map_err(std::io::Error::other)?;
            file.write_all((serde_json::to_string(header)? + "\n").as_bytes())?;
            file.sync_all()?;
            Ok(file)
        };
        let file = begun().writing(path)?;
        Ok(Self {
            path: path.to_owned(),
            file,
            frames: Vec::new(),
            rows: Vec::new(),
            waiting: 0,
            second: (header.rate_hz.ceil() as usize).max(1) * header.signals.len(),
        })
    }

    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Appends interleaved frames. When a full second of frames is waiting, writes them and flushes
    /// the file to disk.
    ///
    /// # Errors
    /// [`LabError::File`].
    pub fn push(&mut self, frames: &[f64]) -> Result<(), LabError> {
        self.frames.extend_from_slice(frames);
        self.waiting += frames.len();
        if self.waiting >= self.second { self.flush() } else { Ok(()) }
    }

    /// Appends interleaved rows of the tracker. The rows are written to disk together with the next
    /// frames.
    pub fn push_tracker(&mut self, rows: &[f64]) {
        self.rows.extend_from_slice(rows);
    }

    /// Writes all waiting frames and rows, and flushes the file to disk.
    ///
    /// # Errors
    /// [`LabError::File`].
    pub fn flush(&mut self) -> Result<(), LabError> {
        let mut bytes = Vec::new();
        append(&mut bytes, FRAMES, &self.frames);
        append(&mut bytes, TRACKER, &self.rows);
        let written = self.file.write_all(&bytes);
        let synced = written.and_then(|()| self.file.sync_data());
        synced.writing(&self.path)?;
        self.frames.clear();
        self.rows.clear();
        self.waiting = 0;
        Ok(())
    }
}

fn append(bytes: &mut Vec<u8>, kind: u8, values: &[f64]) {
    if values.is_empty() {
        return;
    }
    let start = bytes.len();
    bytes.push(kind);
    bytes.extend((size_of_val(values) as u32).to_le_bytes());
    values.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    let hash = blake3::hash(&bytes[start..]);
    bytes.extend(&hash.as_bytes()[..HASH]);
}

/// Reads all whole chunks of a part file. Does not follow links. Returns `None` if the header is
/// incomplete, which means that nothing was recorded.
///
/// # Errors
/// Returns [`LabError::File`] if the file cannot be read or is not a part file. Returns
/// [`LabError::Busy`] if another program is writing to the file.
pub fn read_part(path: &Path) -> Result<Option<TakeData>, LabError> {
    let opened = OwnFolder::of_file(path).and_then(|(folder, name)| folder.open(&name));
    let mut file = opened.map_err(FileError::in_file(path))?;
    // A program that is writing a part file holds the file's lock.
    if let Err(TryLockError::WouldBlock) = file.try_lock_shared() {
        return Err(LabError::busy(path, "recording into it"));
    }
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(FileError::in_file(path))?;
    let Some(end) = bytes.iter().take(MOST_HEADER).position(|b| *b == b'\n') else {
        return Ok(None);
    };
    let header = serde_json::from_slice(&bytes[..end])
        .map_err(|error| error.to_string())
        .and_then(TakeHeader::of_json)
        .map_err(|error| {
            format!(
                "it is not the part of a take that this htex records ({}); move it elsewhere",
                htex_base::finding::plain(&error)
            )
        })
        .map_err(FileError::in_file(path))?;
    let own = files::stem(&header.name, header.number);
    if path.file_stem().is_none_or(|stem| stem != &own[..]) {
        let problem = format!(
            "it is the part of {own}; give it that name again, so that no other take is replaced"
        );
        return Err(FileError::content(path, problem).into());
    }
    Ok(Some(chunks(header, &bytes[end + 1..])))
}

/// Returns the values of all whole chunks.
fn chunks(header: TakeHeader, mut bytes: &[u8]) -> TakeData {
    let mut data = TakeData::empty(header);
    while let Some((kind, values, rest)) = chunk(bytes) {
        match kind {
            FRAMES => data.extend(&values),
            TRACKER => data.extend_tracker(&values),
            _ => break,
        }
        bytes = rest;
    }
    data
}

/// Returns the kind and the values of the first chunk, and the bytes after it.
fn chunk(bytes: &[u8]) -> Option<(u8, Vec<f64>, &[u8])> {
    let length = bytes.get(1..5)?.try_into().ok().map(u32::from_le_bytes)? as usize;
    let end = length.checked_add(5)?;
    let hash = bytes.get(end..end.checked_add(HASH)?)?;
    if !length.is_multiple_of(size_of::<f64>())
        || blake3::hash(&bytes[..end]).as_bytes()[..HASH] != *hash
    {
        return None;
    }
    let number = |bytes: &[u8]| bytes.try_into().ok().map(f64::from_le_bytes);
    let values = bytes[5..end].chunks_exact(8).filter_map(number).collect();
    Some((bytes[0], values, &bytes[end + HASH..]))
}
