//! Decides which embedded modules the textures of a library share, and where the file contains
//! their bytes.
//!
//! The writer compares the hashes of all embedded modules. It stores a module that several textures
//! embed only once. A module that only one texture embeds stays among that texture's own bytes,
//! because sharing it would save nothing.

use std::ops::Range;

use crate::library::entry::{Cut, TexturePlace};
use crate::library::leaf::{MOST_CUTS, length};
use crate::library::spool::{Module, SpoolRange};

/// The modules of all textures. The modules that occur more than once are the shared objects.
pub(crate) struct Sharing {
    modules: Vec<Module>,
    /// Place of each module in the shared part; `None` if only one texture has it.
    places: Vec<Option<Range<u64>>>,
    /// Indices of the shared modules, in file order.
    shared: Vec<usize>,
    bytes: u64,
}

impl Sharing {
    /// Decides which modules are shared. They are sorted by their hashes, so that the file does not
    /// depend on the order in which textures were added.
    pub(crate) fn new(modules: Vec<Module>) -> Self {
        let mut shared: Vec<usize> = (0..modules.len()).filter(|i| modules[*i].uses > 1).collect();
        shared.sort_by_key(|i| modules[*i].blake3);
        let (mut places, mut bytes) = (vec![None; modules.len()], 0);
        for i in &shared {
            let end = bytes + length(&modules[*i].at);
            places[*i] = Some(bytes..end);
            bytes = end;
        }
        Self { modules, places, shared, bytes }
    }

    /// Returns the size of the shared part, bytes.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the number of bytes that sharing modules saves.
    pub(crate) fn saved_bytes(&self) -> u64 {
        let modules = self.shared.iter().map(|i| &self.modules[*i]);
        modules.map(|m| length(&m.at) * (m.uses - 1)).sum()
    }

    /// Returns the ranges of the shared objects in the spool, in file order.
    pub(crate) fn objects(&self) -> impl ExactSizeIterator<Item = Range<u64>> + '_ {
        self.shared.iter().map(|i| self.modules[*i].at.clone())
    }

    /// Returns the place of the texture's bytes in the library. The texture's own bytes begin at
    /// `start` in the payload.
    pub(crate) fn place(&self, spooled: &SpoolRange, start: u64) -> TexturePlace {
        let (mut inlined, mut cuts) = (0, Vec::new());
        for (at, module) in &spooled.modules {
            let module = *module as usize;
            // In the spool, own bytes exclude all modules. In the file they include the modules
            // that only this texture has, so a cut lies further on by the size of those before it.
            match &self.places[module] {
                Some(object) => {
                    cuts.push(Cut { at: u64::from(*at) + inlined, object: object.clone() })
                }
                None => inlined += length(&self.modules[module].at),
            }
        }
        // Modules are entries of the archive, whose number has the same limit.
        debug_assert!(cuts.len() <= MOST_CUTS);
        let own = length(&spooled.own) + inlined;
        TexturePlace { own: start..start + own, cuts }
    }

    /// Returns the ranges of a texture's own bytes in the spool: the bytes around its modules, and
    /// the modules that only this texture has.
    pub(crate) fn own_pieces(&self, spooled: &SpoolRange) -> Vec<Range<u64>> {
        let (mut at, mut pieces) = (spooled.own.start, Vec::new());
        for (before, module) in &spooled.modules {
            let module = *module as usize;
            // A shared module needs no split, because the own bytes before and after it are
            // adjacent in the spool.
            if self.places[module].is_none() {
                let next = spooled.own.start + u64::from(*before);
                pieces.extend([at..next, self.modules[module].at.clone()]);
                at = next;
            }
        }
        pieces.push(at..spooled.own.end);
        pieces
    }
}
