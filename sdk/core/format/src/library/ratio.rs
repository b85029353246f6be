//! Limits the total size of all textures, so that a small file cannot unpack to a huge folder.

use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::fault::Fault;
use crate::library::rules as rule;

/// Adds up the sizes of the textures that a program reads. The sum may be at most
/// [`crate::library::Limits::ratio`] times the size of the library's file. A program that reads all
/// textures, e.g. to check or to unpack them, must call `add` for each texture before it reads that
/// texture.
#[derive(Debug, Clone)]
pub struct Ratio {
    file_bytes: u64,
    most_ratio: u64,
    total: u64,
}

impl Ratio {
    pub(crate) fn new(file_bytes: u64, most_ratio: u64) -> Self {
        Self { file_bytes, most_ratio, total: 0 }
    }

    /// Adds the size of a texture that the program is going to read.
    ///
    /// # Errors
    /// Returns [`LibraryError::Invalid`] if the total size of the textures added so far exceeds the
    /// limit.
    pub fn add(&mut self, entry: &Entry) -> Result<(), LibraryError> {
        Ok(self.count(entry, "")?)
    }

    pub(crate) fn count(&mut self, entry: &Entry, place: &str) -> Result<(), Fault> {
        self.total = self.total.saturating_add(entry.bytes);
        let Self { file_bytes, most_ratio, total } = *self;
        if total <= file_bytes.saturating_mul(most_ratio) {
            return Ok(());
        }
        let message = format!(
            "the textures up to {} have {total} bytes and the file has {file_bytes}; the limit is a ratio of {most_ratio}, raise it if you trust \
             the file",
            entry.name
        );
        Err(Fault::new(rule::LIBRARY_RATIO, place, message))
    }
}
