//! Input from files and from bytes in memory.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom, Take};
use std::path::{Path, PathBuf};

use crate::error::{Fault, ReadProblem};

/// The largest file that is read, bytes. [`crate::MOST_VALUES`] limits how many of its numbers are
/// kept.
const MAX_BYTES: u64 = 4 << 30;

/// Number of bytes that are read to detect the kind of file. An HDF5 signature is at most this far
/// from the start.
const FRONT: usize = 16 << 10;

/// A file, or bytes in memory.
enum Input<'a> {
    /// A file, read up to one byte beyond the size limit. If this extra byte exists, the file is
    /// too long and reading returns an error. Otherwise the first part of a long file could pass
    /// for a whole file.
    File(Take<File>),
    Bytes(&'a [u8]),
}

impl Read for Input<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => {
                let read = file.read(buffer)?;
                // The size of a pipe or a growing file is not known before it is read.
                if read > 0 && file.limit() == 0 {
                    return Err(io::Error::new(
                        io::ErrorKind::FileTooLarge,
                        "it has more bytes than the limit; cut the recording into parts",
                    ));
                }
                Ok(read)
            }
            Self::Bytes(bytes) => bytes.read(buffer),
        }
    }
}

/// An input whose first bytes have been read.
pub(crate) struct InputFile<'a> {
    /// Its path, needed for the extension.
    pub(crate) path: PathBuf,
    /// The first bytes.
    pub(crate) front: Vec<u8>,
    rest: Input<'a>,
}

impl InputFile<'static> {
    /// Opens a file with a size limit.
    pub(crate) fn file(path: &Path) -> Result<Self, Fault> {
        let file = File::open(path)?;
        let bytes = file.metadata()?.len();
        if bytes > MAX_BYTES {
            let limit = MAX_BYTES;
            return Err(ReadProblem::TooLarge { bytes, limit }.into());
        }
        Self::limited(path, file, MAX_BYTES)
    }

    /// Uses an open file of which at most `most_bytes` can be read.
    fn limited(path: &Path, file: File, most_bytes: u64) -> Result<Self, Fault> {
        Self::new(path, Input::File(file.take(most_bytes + 1)))
    }
}

impl<'a> InputFile<'a> {
    /// Uses bytes in place of a file; `path` is not opened.
    pub(crate) fn bytes(path: &Path, bytes: &'a [u8]) -> Result<Self, Fault> {
        Self::new(path, Input::Bytes(bytes))
    }

    /// Reads the first bytes.
    fn new(path: &Path, mut input: Input<'a>) -> Result<Self, Fault> {
        let mut front = Vec::new();
        input.by_ref().take(FRONT as u64).read_to_end(&mut front)?;
        Ok(Self { path: path.to_owned(), front, rest: input })
    }

    /// Returns all bytes in order.
    pub(crate) fn stream(self) -> impl Read + 'a {
        Cursor::new(self.front).chain(self.rest)
    }

    /// Returns the input for random access. An input that can be read only once, such as a pipe, is
    /// read into memory.
    pub(crate) fn random(mut self) -> io::Result<Random> {
        if let Input::File(taken) = &mut self.rest
            && taken.get_ref().metadata()?.is_file()
        {
            let mut file = taken.get_ref().try_clone()?;
            file.seek(SeekFrom::Start(0))?;
            return Ok(Random::File(file));
        }
        let mut bytes = self.front;
        self.rest.read_to_end(&mut bytes)?;
        Ok(Random::Bytes(Cursor::new(bytes)))
    }
}

/// An input for random access.
pub(crate) enum Random {
    File(File),
    Bytes(Cursor<Vec<u8>>),
}

impl Random {
    /// Returns the length in bytes.
    pub(crate) fn len(&self) -> io::Result<u64> {
        match self {
            Self::File(file) => Ok(file.metadata()?.len().min(MAX_BYTES)),
            Self::Bytes(bytes) => Ok(bytes.get_ref().len() as u64),
        }
    }
}

impl Read for Random {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(buffer),
            Self::Bytes(bytes) => bytes.read(buffer),
        }
    }
}

impl Seek for Random {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            Self::File(file) => file.seek(to),
            Self::Bytes(bytes) => bytes.seek(to),
        }
    }
}

/// Returns the file's name without its directory.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
mod tests {
    use super::*;

    /// A pipe states no size, so only reading shows that it is too long.
    #[test]
    fn an_input_beyond_the_limit_is_refused_and_not_cut() {
        let read = |bytes: u64, limit: u64| {
            let mut file = tempfile::tempfile().unwrap();
            io::copy(&mut io::repeat(b'1').take(bytes), &mut file).unwrap();
            file.seek(SeekFrom::Start(0)).unwrap();
            let opened = InputFile::limited(Path::new("pipe.csv"), file, limit);
            let mut all = Vec::new();
            opened.ok()?.stream().read_to_end(&mut all).ok()
        };
        let front = FRONT as u64;
        for limit in [10, front - 1, front, front + 10] {
            assert_eq!(read(limit, limit), Some(limit as usize), "{limit}");
            assert_eq!(read(limit + 1, limit), None, "{limit}");
        }
    }
}
