//! Writing of libraries: to a file, or in memory.

use std::io::{BufWriter, Cursor, Write};
use std::path::Path;

use htex_files::{Scratch, Unfinished};

use crate::error::LibraryError;
use crate::packer::{Packed, Packer, Unchanged};
use crate::spool::ScratchFile;

/// Bytes that are gathered before they are written.
const BUFFER_BYTES: usize = 1 << 20;

/// Writes a library. Textures are added in any order; the same textures give the same bytes.
///
/// What is added is kept in a file beside the target, so that only the index is in memory: about
/// 500 bytes for each texture. The target is written by [`Self::finish`] and renamed into place; a
/// writer that is dropped leaves nothing.
///
/// ```no_run
/// let mut writer = htex_library::Writer::create("cloth.htexlib".as_ref(), "Cloth")?;
/// writer.add("woven/cotton", &std::fs::read("cotton.htex")?)?;
/// let packed = writer.finish()?;
/// println!("{} textures in {} bytes", packed.entries, packed.bytes);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Writer {
    target: Unfinished,
    path: std::path::PathBuf,
    packer: Packer<ScratchFile>,
}

impl Writer {
    /// Starts a library. `path` is the file, `name` the name that people see; it may be empty.
    ///
    /// # Errors
    /// When the name has a control character or more than 255 bytes, or a file cannot be written
    /// there.
    #[allow(clippy::disallowed_methods, reason = "the user named this file")]
    pub fn create(path: &Path, name: &str) -> Result<Self, LibraryError> {
        let target = Unfinished::create(path).unchanged(path)?;
        let scratch = ScratchFile(Scratch::beside(path).unchanged(path)?);
        Ok(Self { target, path: path.to_owned(), packer: Packer::new(path, name, scratch)? })
    }

    /// Packs textures that state no licence, too, which [`Self::finish`] refuses else: nobody but
    /// who made them may pass them on.
    pub fn allow_unlicensed(&mut self) {
        self.packer.allows_unlicensed = true;
    }

    /// Adds a texture: `asset` are the bytes of a `.htex` file, which is stored as it is.
    ///
    /// # Errors
    /// When the name breaks a rule of [`check_name`](crate::check_name) or was added before, in the
    /// same or another case, the asset is not valid or has more tags or longer ones than the index
    /// holds (64 of 255 bytes), or the bytes cannot be written.
    pub fn add(&mut self, name: &str, asset: &[u8]) -> Result<(), LibraryError> {
        self.packer.add(name, asset)
    }

    /// Writes the library and renames it into place.
    ///
    /// # Errors
    /// When a texture states no licence, a file cannot be written, or the library exceeds the
    /// default limits of readers.
    pub fn finish(self) -> Result<Packed, LibraryError> {
        let Self { mut target, path, packer } = self;
        let mut file = BufWriter::with_capacity(BUFFER_BYTES, target.file());
        let packed = packer.finish(&mut file)?;
        let written = file.flush();
        drop(file);
        written.and_then(|()| target.keep()).unchanged(&path)?;
        Ok(packed)
    }
}

/// As [`Writer`], in memory: for programs without files.
///
/// ```
/// let writer = htex_library::MemoryWriter::new("Cloth")?;
/// let (packed, bytes) = writer.finish()?;
/// assert_eq!((packed.entries, packed.bytes), (0, bytes.len() as u64));
/// # Ok::<(), htex_library::LibraryError>(())
/// ```
pub struct MemoryWriter(Packer<Cursor<Vec<u8>>>);

impl MemoryWriter {
    /// Starts a library; `name` may be empty.
    ///
    /// # Errors
    /// As [`Writer::create`].
    pub fn new(name: &str) -> Result<Self, LibraryError> {
        Packer::new(Path::new(""), name, Cursor::default()).map(Self)
    }

    /// As [`Writer::allow_unlicensed`].
    pub fn allow_unlicensed(&mut self) {
        self.0.allows_unlicensed = true;
    }

    /// Adds a texture.
    ///
    /// # Errors
    /// As [`Writer::add`].
    pub fn add(&mut self, name: &str, asset: &[u8]) -> Result<(), LibraryError> {
        self.0.add(name, asset)
    }

    /// Returns the library.
    ///
    /// # Errors
    /// When a texture states no licence, or the library exceeds the default limits of readers.
    pub fn finish(self) -> Result<(Packed, Vec<u8>), LibraryError> {
        let mut bytes = Vec::new();
        let packed = self.0.finish(&mut bytes)?;
        Ok((packed, bytes))
    }
}
