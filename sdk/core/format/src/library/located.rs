//! Opens libraries by path or URI.

use std::io;

use htex_base::storage::{Location, Remote, Storage};

use crate::library::error::LibraryError;
use crate::library::opening::FIRST_READ;
use crate::library::reader::Library;
use crate::library::source::{LibrarySource, LocalFile};

/// A local or remote file, from which the program reads only the ranges that it needs.
#[derive(Debug)]
pub enum LibraryFile {
    /// A local file.
    File(LocalFile),
    /// A file on a web server or in an object store.
    Elsewhere(Box<Remote>),
}

impl Library<LibraryFile> {
    /// Opens a library by path or URI, within the default [`Limits`](crate::library::Limits).
    ///
    /// Opening one texture of a remote file takes three requests: the start of the file, a page of
    /// the index, and the texture. For a small library, the start of the file already contains the
    /// whole index, so two requests are enough.
    ///
    /// # Errors
    /// Returns the errors of [`Library::open`], or [`LibraryError::Storage`] if a remote file
    /// cannot be opened.
    ///
    /// ```
    /// use htex_format::library::Library;
    /// use htex_base::storage::{Location, Storage};
    ///
    /// let storage = Storage::from_environment()?;
    /// let location = Location::parse("s3://textures/cloth.htexlib".as_ref())?; // or "cloth.htexlib"
    /// # return Ok::<(), Box<dyn std::error::Error>>(());
    /// let cotton = Library::open_located(&storage, &location)?.get("woven/cotton")?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn open_located(storage: &Storage, location: &Location) -> Result<Self, LibraryError> {
        Self::open_source(LibraryFile::open(storage, location)?)
    }
}

impl LibraryFile {
    /// Opens a file by path or URI.
    ///
    /// # Errors
    /// Returns [`LibraryError::Open`] if a local file cannot be opened, and
    /// [`LibraryError::Storage`] if a remote file cannot be opened.
    pub fn open(storage: &Storage, location: &Location) -> Result<Self, LibraryError> {
        if let Some(path) = location.local() {
            return LocalFile::open(path).map(Self::File);
        }
        let first = u32::try_from(FIRST_READ).unwrap_or(u32::MAX);
        let remote = storage.open(location, first)?;
        Ok(Self::Elsewhere(Box::new(remote)))
    }

    /// Returns the number of requests to the server so far and the number of bytes received.
    /// Returns `None` for a local file.
    pub fn usage(&self) -> Option<htex_base::storage::Usage> {
        match self {
            Self::File(_) => None,
            Self::Elsewhere(remote) => Some(remote.usage()),
        }
    }
}

impl LibrarySource for LibraryFile {
    fn len(&self) -> io::Result<u64> {
        match self {
            Self::File(file) => LibrarySource::len(file),
            Self::Elsewhere(remote) => Ok(remote.len()),
        }
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read_at(offset, buffer),
            Self::Elsewhere(remote) => {
                // A remote file refuses a range that ends beyond the file. For such a range, this
                // trait must return fewer bytes.
                let there = remote.len().saturating_sub(offset);
                let count = usize::try_from(there).map_or(buffer.len(), |n| n.min(buffer.len()));
                remote.read_at(offset, &mut buffer[..count]).map_err(io::Error::other)?;
                Ok(count)
            }
        }
    }
}
