//! Sources from which a library reads its bytes.

use std::fs::File;
use std::io;
use std::path::Path;

use crate::library::error::LibraryError;

/// A source of a library's bytes: a local file, a buffer, or a file on a server.
///
/// A library reads a few large ranges of the source's bytes. When it is opened, it reads the first
/// 16 KiB. For each texture, it reads a page of the index and the texture's bytes.
pub trait LibrarySource {
    /// Returns the length of the file, bytes. The library calls this function only after the first
    /// read, so a network source can take the length from its first response.
    ///
    /// # Errors
    /// The errors of the source.
    fn len(&self) -> io::Result<u64>;

    /// Returns whether the file is empty.
    ///
    /// # Errors
    /// The errors of the source.
    fn is_empty(&self) -> io::Result<bool> {
        Ok(self.len()? == 0)
    }

    /// Fills `buffer` with the bytes that start at `offset`. Returns the number of bytes read,
    /// which is less than the buffer's length only at the end of the file.
    ///
    /// # Errors
    /// The errors of the source.
    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize>;
}

/// A local file.
#[derive(Debug)]
pub struct LocalFile(File);

impl LocalFile {
    /// Opens a file.
    ///
    /// # Errors
    /// Returns [`LibraryError::Open`] if the file cannot be opened.
    pub fn open(path: &Path) -> Result<Self, LibraryError> {
        let file = File::open(path)
            .map_err(|error| LibraryError::Open { path: path.to_owned(), error })?;
        Ok(Self(file))
    }
}

impl LibrarySource for LocalFile {
    fn len(&self) -> io::Result<u64> {
        self.0.metadata().map(|metadata| metadata.len())
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        while filled < buffer.len() {
            match read_some(&self.0, offset + filled as u64, &mut buffer[filled..]) {
                Ok(0) => break,
                Ok(count) => filled += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(filled)
    }
}

#[cfg(unix)]
fn read_some(file: &File, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, buffer, offset)
}

#[cfg(windows)]
fn read_some(file: &File, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, buffer, offset)
}

#[cfg(not(any(unix, windows)))]
fn read_some(mut file: &File, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
    use std::io::{Read, Seek, SeekFrom};
    file.seek(SeekFrom::Start(offset))?;
    file.read(buffer)
}

impl LibrarySource for [u8] {
    fn len(&self) -> io::Result<u64> {
        Ok(<[u8]>::len(self) as u64)
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let there = self.get(start..).unwrap_or_default();
        let count = there.len().min(buffer.len());
        buffer[..count].copy_from_slice(&there[..count]);
        Ok(count)
    }
}

impl LibrarySource for Vec<u8> {
    fn len(&self) -> io::Result<u64> {
        LibrarySource::len(self.as_slice())
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        self.as_slice().read_at(offset, buffer)
    }
}

impl<S: LibrarySource + ?Sized> LibrarySource for &S {
    fn len(&self) -> io::Result<u64> {
        (**self).len()
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        (**self).read_at(offset, buffer)
    }
}
