//! The pieces from which a packer assembles textures, and the stores that contain the bytes of the
//! pieces.

use std::collections::HashMap;
use std::io::{self, Write};
use std::ops::Range;

use crate::entry_ranges;
use crate::library::reader::Library;
use crate::library::source::LibrarySource;

/// Prefix of the names of archive entries that textures can share: embedded models.
const MODULES: &str = "plugins/";
/// Smallest size of a shared module, bytes. The place of a smaller module in the index would take
/// up much of the space that sharing saves.
const LEAST_SHARED: usize = 64;

/// A range of bytes in a store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Piece {
    /// Index of the store that contains the bytes; 0 is the spool (a temporary store for added
    /// textures).
    pub store: u32,
    pub range: Range<u64>,
}

/// The pieces of a texture.
#[derive(Debug, Clone)]
pub(crate) struct Pieces {
    /// The texture's own bytes: all bytes except the bytes of its objects.
    pub own: Piece,
    /// A pair of numbers for each object of the texture. The first number says how many of the
    /// texture's own bytes precede the object. The second number is the object's index in
    /// [`Objects`].
    pub objects: Box<[(u32, u32)]>,
}

/// Bytes that several textures may have in common.
pub(crate) struct Object {
    pub blake3: [u8; 32],
    pub piece: Piece,
    /// How often the object occurs in all textures together.
    pub uses: u64,
    /// `true` if the object is a part of a texture; only equal textures can share such a part. This
    /// is false for modules.
    pub is_part: bool,
}

/// All objects, each only once.
#[derive(Default)]
pub(crate) struct Objects {
    pub all: Vec<Object>,
    by_hash: HashMap<[u8; 32], u32>,
}

impl Objects {
    /// Counts a use of an object, and returns its index. If the object is new, `piece` puts it into
    /// a store.
    pub(crate) fn add<E>(
        &mut self,
        bytes: &[u8],
        is_part: bool,
        piece: impl FnOnce() -> Result<Piece, E>,
    ) -> Result<u32, E> {
        let blake3 = *blake3::hash(bytes).as_bytes();
        if let Some(index) = self.by_hash.get(&blake3).copied() {
            self.use_again(index, is_part);
            return Ok(index);
        }
        let index = self.all.len() as u32;
        self.all.push(Object { blake3, piece: piece()?, uses: 1, is_part });
        self.by_hash.insert(blake3, index);
        Ok(index)
    }

    /// Counts one more use of an object.
    pub(crate) fn use_again(&mut self, object: u32, is_part: bool) {
        let object = &mut self.all[object as usize];
        object.uses += 1;
        object.is_part &= is_part;
    }

    /// Counts one more use of each object of a texture, or one fewer if `is_more` is false.
    pub(crate) fn count(&mut self, pieces: &Pieces, is_more: bool) {
        for (_, object) in &pieces.objects {
            let uses = &mut self.all[*object as usize].uses;
            *uses = if is_more { *uses + 1 } else { uses.saturating_sub(1) };
        }
    }
}

/// Returns the ranges of an asset's embedded modules that are large enough to be shared.
pub(crate) fn modules(asset: &[u8]) -> Vec<Range<usize>> {
    let entries = entry_ranges(asset).into_iter();
    let large = entries.filter(|e| e.name.starts_with(MODULES) && e.data.len() >= LEAST_SHARED);
    large.map(|entry| entry.data).collect()
}

/// Copies bytes out of a store.
pub(crate) trait Source {
    fn copy(&mut self, range: Range<u64>, to: &mut dyn Write) -> io::Result<()>;
}

/// Number of bytes that are read from a library at once.
const READ_BYTES: u64 = 4 << 20;

/// A library whose textures are packed again. The ranges of its pieces are byte ranges of its file.
impl<S: LibrarySource> Source for Library<S> {
    fn copy(&mut self, range: Range<u64>, to: &mut dyn Write) -> io::Result<()> {
        let mut at = range.start;
        while at < range.end {
            let end = range.end.min(at + READ_BYTES);
            to.write_all(&self.read_range(at..end)?)?;
            at = end;
        }
        Ok(())
    }
}
