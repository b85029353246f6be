//! Writes libraries to a file or to memory.

use std::io::{BufWriter, Cursor, Write};
use std::path::Path;

use htex_base::files::{FileInProgress, Scratch};

use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::metadata::LibraryMetadata;
use crate::library::packer::{PackSummary, Packer};
use crate::library::prepared::{Describe, PreparedTexture};
use crate::library::reader::Library;
use crate::library::source::LibrarySource;
use crate::library::spool::ScratchFile;

/// Number of bytes that the writer collects in memory before it writes them.
const BUFFER_BYTES: usize = 1 << 20;

/// Writes a library file. Textures may be added in any order: the same textures always give the
/// same bytes.
///
/// The writer stores added textures in a temporary file next to the target. It keeps only the index
/// in memory, about 500 bytes for each texture. [`Self::finish`] writes the library to another
/// temporary file and renames it to the target. If the writer is dropped without a call of
/// `finish`, no file remains.
///
/// ```no_run
/// let mut writer = htex_format::library::Writer::create("cloth.htexlib".as_ref(), "Cloth")?;
/// writer.add("woven/cotton", &std::fs::read("cotton.htex")?)?;
/// let packed = writer.finish()?;
/// println!("{} textures in {} bytes", packed.entries, packed.bytes);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Writer {
    target: FileInProgress,
    path: std::path::PathBuf,
    packer: Packer<ScratchFile>,
}

impl Writer {
    /// Starts a library. `path` is the file to write. `name` is the library's name, which programs
    /// show to users; it may be empty.
    ///
    /// # Errors
    /// Returns an error if the name has a control character or more than 255 bytes, or if no file
    /// can be written to the folder of `path`.
    #[allow(clippy::disallowed_methods, reason = "the user named this file")]
    pub fn create(path: &Path, name: &str) -> Result<Self, LibraryError> {
        let target = FileInProgress::create(path).map_err(LibraryError::unchanged(path))?;
        let scratch = ScratchFile(Scratch::beside(path).map_err(LibraryError::unchanged(path))?);
        Ok(Self { target, path: path.to_owned(), packer: Packer::new(path, name, scratch)? })
    }

    /// Allows textures that state no licence. Without this call, [`Self::finish`] returns an error
    /// for such textures, because only the authors of such a texture may pass it on.
    pub fn allow_unlicensed(&mut self) {
        self.packer.allows_unlicensed = true;
    }

    /// Sets the library's metadata, such as its version and authors.
    pub fn set_metadata(&mut self, metadata: LibraryMetadata) {
        self.packer.metadata = metadata;
    }

    /// Sets the function that computes the description of each texture that is added without a
    /// description.
    pub fn describe_with(&mut self, describe: Describe) {
        self.packer.describe = Some(describe);
    }

    /// Adds a texture that has already been checked, perhaps by another thread.
    ///
    /// # Errors
    /// Returns the errors of [`Self::add`], except the error for an asset that is not valid.
    pub fn add_prepared(
        &mut self,
        name: &str,
        texture: PreparedTexture,
    ) -> Result<(), LibraryError> {
        self.packer.add_prepared(name, texture)
    }

    /// Adds a texture. `asset` contains the bytes of a `.htex` file. The library stores them
    /// unchanged.
    ///
    /// # Errors
    /// - The name breaks a rule of [`check_name`](crate::library::check_name), or equals an earlier
    ///   name apart from case and Unicode normalisation.
    /// - The asset is not valid, or its tags are too many or too long for the index (64 tags of 255
    ///   bytes).
    /// - The bytes cannot be written.
    pub fn add(&mut self, name: &str, asset: &[u8]) -> Result<(), LibraryError> {
        self.packer.add(name, asset)
    }

    /// Adds the textures of another library unchanged, without unpacking them. The function `name`
    /// receives each entry, in the order of the entries' names. It returns the texture's new name,
    /// or `None` to leave the texture out.
    ///
    /// The textures are not checked again. [`validate`](crate::library::validate) checks a library
    /// that may be damaged.
    ///
    /// ```no_run
    /// use htex_format::library::{Library, Writer};
    /// let mut writer = Writer::create("both.htexlib".as_ref(), "Both")?;
    /// for part in ["wood", "cloth"] {
    ///     let library = Library::open(format!("{part}.htexlib").as_ref())?;
    ///     writer.add_library(library, |entry| Some(format!("{part}/{}", entry.name)))?;
    /// }
    /// writer.finish()?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// - A page of the other library cannot be read or breaks a rule.
    /// - A new name breaks a rule, or the library already contains the name; the rules are the same
    ///   as for [`Self::add`].
    pub fn add_library<S: LibrarySource + Send + 'static>(
        &mut self,
        library: Library<S>,
        name: impl FnMut(&Entry) -> Option<String>,
    ) -> Result<(), LibraryError> {
        self.packer.add_library(library, name)
    }

    /// Writes the library and renames it to the target.
    ///
    /// # Errors
    /// Returns an error if a texture states no licence, a file cannot be written, the metadata
    /// break a rule ([`LibraryMetadata::check`]), or the library exceeds the default limits of
    /// readers.
    pub fn finish(self) -> Result<PackSummary, LibraryError> {
        let Self { mut target, path, packer } = self;
        let mut file = BufWriter::with_capacity(BUFFER_BYTES, target.file());
        let packed = packer.finish(&mut file)?;
        let written = file.flush();
        drop(file);
        written.and_then(|()| target.keep()).map_err(LibraryError::unchanged(&path))?;
        Ok(packed)
    }
}

/// Writes a library to memory instead of a file, for programs without a file system. See
/// [`Writer`].
///
/// ```
/// let writer = htex_format::library::MemoryWriter::new("Cloth")?;
/// let (packed, bytes) = writer.finish()?;
/// assert_eq!((packed.entries, packed.bytes), (0, bytes.len() as u64));
/// # Ok::<(), htex_format::library::LibraryError>(())
/// ```
pub struct MemoryWriter(Packer<Cursor<Vec<u8>>>);

impl MemoryWriter {
    /// Starts a library. `name` may be empty.
    ///
    /// # Errors
    /// Returns the errors of [`Writer::create`].
    pub fn new(name: &str) -> Result<Self, LibraryError> {
        Packer::new(Path::new(""), name, Cursor::default()).map(Self)
    }

    /// Allows textures that state no licence, as [`Writer::allow_unlicensed`] does.
    pub fn allow_unlicensed(&mut self) {
        self.0.allows_unlicensed = true;
    }

    /// Sets the library's metadata, as [`Writer::set_metadata`] does.
    pub fn set_metadata(&mut self, metadata: LibraryMetadata) {
        self.0.metadata = metadata;
    }

    /// Sets the function that computes descriptions, as [`Writer::describe_with`] does.
    pub fn describe_with(&mut self, describe: Describe) {
        self.0.describe = Some(describe);
    }

    /// Adds a texture, as [`Writer::add`] does.
    ///
    /// # Errors
    /// Returns the errors of [`Writer::add`].
    pub fn add(&mut self, name: &str, asset: &[u8]) -> Result<(), LibraryError> {
        self.0.add(name, asset)
    }

    /// Returns the library's bytes.
    ///
    /// # Errors
    /// Returns the errors of [`Writer::finish`].
    pub fn finish(self) -> Result<(PackSummary, Vec<u8>), LibraryError> {
        let mut bytes = Vec::new();
        let packed = self.0.finish(&mut bytes)?;
        Ok((packed, bytes))
    }
}
