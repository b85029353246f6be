//! The spool: a temporary store for the added textures while a library is written. Every embedded
//! module is stored in the spool only once. The spool is a file next to the library, or memory.

use std::collections::HashMap;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;

use crate::entry_ranges;
use htex_base::files::Scratch;

/// Prefix of the names of archive entries that textures can share: embedded models.
const MODULES: &str = "plugins/";
/// Smallest size of a shared object, bytes. For a smaller object, its place in the index would cost
/// much of what sharing saves.
const LEAST_SHARED: usize = 64;

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

/// Writes textures to the spool.
pub(crate) struct Spool<S> {
    store: S,
    buffer: Vec<u8>,
    end: u64,
    modules: Vec<Module>,
    by_hash: HashMap<[u8; 32], u32>,
}

/// An embedded module.
pub(crate) struct Module {
    pub blake3: [u8; 32],
    /// Range of the module's bytes in the spool.
    pub at: Range<u64>,
    /// Number of times that textures embed the module.
    pub uses: u64,
}

/// Place of a texture's bytes in the spool.
#[derive(Debug, Clone)]
pub(crate) struct SpoolRange {
    /// Range of the texture's own bytes, i.e. of all its bytes except its modules.
    pub own: Range<u64>,
    /// A pair of numbers for each module of the texture. The first number says how many of the
    /// texture's own bytes precede the module; the second is the module's index in the spool.
    pub modules: Box<[(u32, u32)]>,
}

/// Number of bytes collected in memory before they are written.
// A texture has a few kilobytes, so without this buffer each would cost a call of the system.
const BUFFER_BYTES: usize = 1 << 20;

impl<S: Store> Spool<S> {
    pub(crate) fn new(store: S) -> Self {
        Self { store, buffer: Vec::new(), end: 0, modules: Vec::new(), by_hash: HashMap::new() }
    }

    /// Adds a texture, which must be a valid asset.
    pub(crate) fn add(&mut self, asset: &[u8]) -> io::Result<SpoolRange> {
        let modules = entry_ranges(asset).into_iter();
        let modules =
            modules.filter(|e| e.name.starts_with(MODULES) && e.data.len() >= LEAST_SHARED);
        let ranges: Vec<Range<usize>> = modules.map(|entry| entry.data).collect();
        // All modules are written first, so that the texture's own bytes are adjacent in the spool.
        let mut found = Vec::with_capacity(ranges.len());
        for range in &ranges {
            found.push(self.add_module(&asset[range.clone()])?);
        }
        let start = self.end;
        let (mut at, mut cuts) = (0, Vec::with_capacity(ranges.len()));
        for (range, module) in ranges.iter().zip(found) {
            self.write(&asset[at..range.start])?;
            // A valid asset has at most 16 MiB, so 32 bits are enough. They keep the memory for
            // each texture small.
            cuts.push(((self.end - start) as u32, module));
            at = range.end;
        }
        self.write(&asset[at..])?;
        Ok(SpoolRange { own: start..self.end, modules: cuts.into() })
    }

    /// Adds a module, or counts one more use if the spool already contains it. Returns the module's
    /// index.
    fn add_module(&mut self, bytes: &[u8]) -> io::Result<u32> {
        let blake3 = *blake3::hash(bytes).as_bytes();
        if let Some(index) = self.by_hash.get(&blake3) {
            self.modules[*index as usize].uses += 1;
            return Ok(*index);
        }
        let at = self.end;
        self.write(bytes)?;
        let index = self.modules.len() as u32;
        self.by_hash.insert(blake3, index);
        self.modules.push(Module { blake3, at: at..self.end, uses: 1 });
        Ok(index)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.buffer.extend_from_slice(bytes);
        self.end += bytes.len() as u64;
        if self.buffer.len() >= BUFFER_BYTES {
            self.flush()?;
        }
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.store.write_all(&self.buffer)?;
        self.buffer.clear();
        Ok(())
    }

    pub(crate) fn finish(mut self) -> io::Result<(SpoolReader<S>, Vec<Module>)> {
        self.flush()?;
        self.store.rewind()?;
        let reader =
            SpoolReader { store: BufReader::with_capacity(BUFFER_BYTES, self.store), at: 0 };
        Ok((reader, self.modules))
    }
}

/// Reads ranges of the spool.
pub(crate) struct SpoolReader<S> {
    store: BufReader<S>,
    at: u64,
}

impl<S: Store> SpoolReader<S> {
    /// Copies a range of the spool to `to`.
    pub(crate) fn copy(&mut self, range: Range<u64>, to: &mut impl Write) -> io::Result<()> {
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

    fn seek(&mut self, to: u64) -> io::Result<()> {
        match i64::try_from(i128::from(to) - i128::from(self.at)) {
            // A relative seek keeps the buffer if the target is inside it.
            Ok(offset) => self.store.seek_relative(offset),
            Err(_) => self.store.seek(SeekFrom::Start(to)).map(|_| ()),
        }
    }
}
