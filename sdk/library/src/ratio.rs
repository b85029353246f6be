//! The limit of all textures together: a small file must not become a large folder.

use crate::entry::Entry;
use crate::error::LibraryError;
use crate::fault::Fault;
use crate::rules as rule;

/// Counts the bytes of textures that are read one after another, against [`crate::Limits::ratio`]
/// times the bytes of the file. Whoever reads all of them, to check or to unpack, counts first.
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

    /// Counts a texture that is about to be read.
    ///
    /// # Errors
    /// [`LibraryError::Invalid`] when all so far are larger than the limit.
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
