//! The spool: a temporary store for the added textures while a library is written. The spool is a
//! temporary file next to the library, or a buffer in memory.

use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;

use htex_base::files::Scratch;

use crate::library::pieces::{Piece, Source};

/// The storage of the spooled bytes.
pub(crate) trait Store: Read + Write + Seek {}

impl<T: Read + Write + Seek> Store for T {}

/// A temporary file that is removed when it is dropped.
pub(crate) struct ScratchFile(pub(crate) Scratch);

impl Read for ScratchFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.file().read(buffer)
    }
}

impl Write for ScratchFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.file().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.file().flush()
    }
}

impl Seek for ScratchFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.file().seek(to)
    }
}

/// Writes bytes to the spool.
pub(crate) struct Spool<S> {
    store: S,
    buffer: Vec<u8>,
    end: u64,
}

/// Number of bytes collected in memory before they are written.
// A texture has only a few kilobytes. Without this buffer, each texture would need a system call.
const BUFFER_BYTES: usize = 1 << 20;

impl<S: Store> Spool<S> {
    pub(crate) fn new(store: S) -> Self {
        Self { store, buffer: Vec::new(), end: 0 }
    }

    /// Returns where the next bytes will be.
    pub(crate) fn end(&self) -> u64 {
        self.end
    }

    /// Adds bytes, and returns where they are.
    pub(crate) fn add(&mut self, bytes: &[u8]) -> io::Result<Piece> {
        let start = self.end;
        self.buffer.extend_from_slice(bytes);
        self.end += bytes.len() as u64;
        if self.buffer.len() >= BUFFER_BYTES {
            self.flush()?;
        }
        Ok(Piece { store: 0, range: start..self.end })
    }

    fn flush(&mut self) -> io::Result<()> {
        self.store.write_all(&self.buffer)?;
        self.buffer.clear();
        Ok(())
    }

    pub(crate) fn finish(mut self) -> io::Result<SpoolReader<S>> {
        self.flush()?;
        self.store.rewind()?;
        Ok(SpoolReader { store: BufReader::with_capacity(BUFFER_BYTES, self.store), at: 0 })
    }
}

/// Reads ranges of the spool.
pub(crate) struct SpoolReader<S> {
    store: BufReader<S>,
    at: u64,
}

impl<S: Store> Source for SpoolReader<S> {
    fn copy(&mut self, range: Range<u64>, to: &mut dyn Write) -> io::Result<()> {
        if range.start != self.at {
            self.seek(range.start)?;
        }
        let length = range.end - range.start;
        let copied = io::copy(&mut (&mut self.store).take(length), to)?;
        self.at = range.start + copied;
        if copied == length {
            return Ok(());
        }
        Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the temporary file was cut off"))
    }
}

impl<S: Store> SpoolReader<S> {
    fn seek(&mut self, to: u64) -> io::Result<()> {
        match i64::try_from(i128::from(to) - i128::from(self.at)) {
            // A relative seek keeps the buffer if the target is inside it.
            Ok(offset) => self.store.seek_relative(offset),
            Err(_) => self.store.seek(SeekFrom::Start(to)).map(|_| ()),
        }
    }
}
