//! Decides which objects the textures of a library share, and where in the file the bytes of these
//! objects are.
//!
//! The writer compares the hashes of all embedded modules, and of all textures. If several textures
//! embed the same module, the writer stores the module once. It also stores equal textures once. If
//! only one texture contains a module, the writer keeps the module among that texture's own bytes,
//! because sharing it would save nothing.

use std::ops::Range;

use crate::library::entry::{Cut, TexturePlace};
use crate::library::leaf::{MOST_CUTS, length};
use crate::library::pieces::{Object, Piece, Pieces};

/// The objects of all textures. Objects that occur more than once are shared.
pub(crate) struct Sharing {
    objects: Vec<Object>,
    /// Place of each object in the shared part; `None` if only one texture has it.
    places: Vec<Option<Range<u64>>>,
    /// Indices of the shared objects, in file order.
    shared: Vec<usize>,
    bytes: u64,
}

impl Sharing {
    /// Decides which objects are shared. The shared objects are sorted by their hashes, so that the
    /// file does not depend on the order in which textures were added. If `has_parts` is false,
    /// equal textures share only their modules.
    pub(crate) fn new(objects: Vec<Object>, has_parts: bool) -> Self {
        let is_shared = |object: &Object| object.uses > 1 && (has_parts || !object.is_part);
        let mut shared: Vec<usize> =
            (0..objects.len()).filter(|i| is_shared(&objects[*i])).collect();
        shared.sort_by_key(|i| objects[*i].blake3);
        let (mut places, mut bytes) = (vec![None; objects.len()], 0);
        for i in &shared {
            let end = bytes + length(&objects[*i].piece.range);
            places[*i] = Some(bytes..end);
            bytes = end;
        }
        Self { objects, places, shared, bytes }
    }

    /// Decides again, but now equal textures share only their modules.
    pub(crate) fn without_parts(self) -> Self {
        Self::new(self.objects, false)
    }

    /// Returns the size of the shared part, bytes.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the number of bytes that sharing saves.
    pub(crate) fn saved_bytes(&self) -> u64 {
        let objects = self.shared.iter().map(|i| &self.objects[*i]);
        objects.map(|object| length(&object.piece.range) * (object.uses - 1)).sum()
    }

    /// Returns the shared objects, in file order.
    pub(crate) fn shared(&self) -> impl ExactSizeIterator<Item = &Piece> + '_ {
        self.shared.iter().map(|i| &self.objects[*i].piece)
    }

    /// Returns the place of the texture's bytes in the library. The texture's own bytes begin at
    /// `start` in the payload.
    pub(crate) fn place(&self, pieces: &Pieces, start: u64) -> TexturePlace {
        let (mut inlined, mut cuts) = (0, Vec::new());
        for (at, object) in &pieces.objects {
            let object = *object as usize;
            // In the store, a texture's own bytes do not include any objects. In the file, they
            // include the objects that only this texture has. Therefore, the position of a cut
            // increases by the size of such objects before it.
            match &self.places[object] {
                Some(place) => {
                    cuts.push(Cut { at: u64::from(*at) + inlined, object: place.clone() })
                }
                None => inlined += length(&self.objects[object].piece.range),
            }
        }
        debug_assert!(cuts.len() <= MOST_CUTS);
        let own = length(&pieces.own.range) + inlined;
        TexturePlace { own: start..start + own, cuts, ..TexturePlace::default() }
    }

    /// Returns a texture's own bytes: the bytes around its objects, and the objects that only this
    /// texture has.
    pub(crate) fn own_pieces(&self, pieces: &Pieces) -> Vec<Piece> {
        let Piece { store, range } = &pieces.own;
        let own = |range| Piece { store: *store, range };
        let (mut at, mut all) = (range.start, Vec::new());
        for (before, object) in &pieces.objects {
            let object = *object as usize;
            // A shared object needs no split, because the own bytes before and after it are
            // adjacent in their store.
            if self.places[object].is_none() {
                let next = range.start + u64::from(*before);
                all.extend([own(at..next), self.objects[object].piece.clone()]);
                at = next;
            }
        }
        all.push(own(at..range.end));
        all
    }
}
