//! Which embedded modules textures share, and where their bytes are then.
//!
//! What several textures embed is found by its hash while a library is written, and stored once.

use std::ops::Range;

use crate::entry::{Cut, TexturePlace};
use crate::leaf::{MOST_CUTS, length};
use crate::spool::{Module, Spooled};

/// The modules of all textures, and which of them are shared objects: those that occur more than
/// once.
pub(crate) struct Sharing {
    modules: Vec<Module>,
    /// Place of each module in the shared part; `None` for one that only one texture has.
    places: Vec<Option<Range<u64>>>,
    /// Indices of the shared modules, in the order of the file.
    shared: Vec<usize>,
    bytes: u64,
}

impl Sharing {
    /// Decides which modules are shared. Their order is that of their hashes, whatever the order of
    /// adding.
    pub(crate) fn of(modules: Vec<Module>) -> Self {
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

    /// Returns the bytes of the shared part.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns the bytes that are not in the file because they are shared.
    pub(crate) fn saved_bytes(&self) -> u64 {
        let modules = self.shared.iter().map(|i| &self.modules[*i]);
        modules.map(|m| length(&m.at) * (m.uses - 1)).sum()
    }

    /// Returns where in the spool the shared objects are, in the order of the file.
    pub(crate) fn objects(&self) -> impl ExactSizeIterator<Item = Range<u64>> + '_ {
        self.shared.iter().map(|i| self.modules[*i].at.clone())
    }

    /// Returns where the bytes of a texture will be; its own begin at `start` of the payload.
    pub(crate) fn place(&self, spooled: &Spooled, start: u64) -> TexturePlace {
        let (mut inlined, mut cuts) = (0, Vec::new());
        for (at, module) in &spooled.modules {
            let module = *module as usize;
            match &self.places[module] {
                Some(object) => {
                    cuts.push(Cut { at: u64::from(*at) + inlined, object: object.clone() })
                }
                None => inlined += length(&self.modules[module].at),
            }
        }
        // An archive has at most as many entries, of which modules are some.
        debug_assert!(cuts.len() <= MOST_CUTS);
        let own = length(&spooled.own) + inlined;
        TexturePlace { own: start..start + own, cuts }
    }

    /// Returns where in the spool a texture's own bytes are: those around its modules, and the
    /// modules that only it has.
    pub(crate) fn own_pieces(&self, spooled: &Spooled) -> Vec<Range<u64>> {
        let (mut at, mut pieces) = (spooled.own.start, Vec::new());
        for (before, module) in &spooled.modules {
            let module = *module as usize;
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
