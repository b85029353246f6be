//! The index of an open library, without input or output: says where pages and textures are, and
//! reads their bytes.

use std::ops::Range;

use htex_finding::{Finding, Findings};

use crate::entry::Entry;
use crate::error::LibraryError;
use crate::fault::{Fault, leaf_place};
use crate::header::{Header, MAJOR, MINOR};
use crate::leaf::LeafReader;
use crate::limits::Limits;
use crate::page;
use crate::ratio::Ratio;
use crate::root::Root;
use crate::rules as rule;

/// The header and the root page of a library.
///
/// A texture is opened in three steps: [`Self::leaf_of`] its name and [`Self::leaf_range`] say
/// which page of the index to read, [`Self::read_leaf`] finds its entry there, and
/// [`Self::asset_ranges`] says which bytes [`Self::assemble`] makes the texture of.
/// [`crate::Library`] does so from a [`crate::LibrarySource`].
#[derive(Debug, Clone)]
pub struct Index {
    header: Header,
    root: Root,
    limits: Limits,
}

impl Index {
    pub(crate) fn new(header: Header, root: Root, limits: Limits) -> Self {
        Self { header, root, limits }
    }

    pub(crate) fn header(&self) -> &Header {
        &self.header
    }

    /// Returns the name of the library; it may be empty.
    pub fn name(&self) -> &str {
        &self.root.name
    }

    /// Returns the number of textures.
    #[allow(clippy::len_without_is_empty)] // The library has `is_empty`.
    pub fn len(&self) -> u64 {
        self.header.entries
    }

    /// Returns the BLAKE3 of the index, which names the library: equal hashes mean equal textures
    /// under equal names.
    pub fn blake3(&self) -> [u8; 32] {
        self.header.index_blake3
    }

    /// Returns findings that are not errors, such as a newer minor version.
    pub fn notes(&self) -> Vec<Finding> {
        let mut findings = Findings::default();
        if self.header.minor > MINOR {
            let message = format!(
                "the library has version {MAJOR}.{} and this program supports {MAJOR}.{MINOR}; what is new is ignored",
                self.header.minor
            );
            findings.add(rule::LIBRARY_VERSION_NEWER, "/header", message);
        }
        findings.into_list()
    }

    pub(crate) fn ratio(&self) -> Ratio {
        Ratio::new(self.header.payload.end, self.limits.ratio)
    }

    /// Returns the number of leaf pages.
    pub fn leaves(&self) -> usize {
        self.root.leaves()
    }

    /// Returns the leaf page that has the entry of this name, if any has it.
    pub fn leaf_of(&self, name: &str) -> Option<usize> {
        self.root.leaf_of(name.as_bytes())
    }

    /// Returns the bytes of a leaf page in the file; `None` when there is no such page.
    pub fn leaf_range(&self, leaf: usize) -> Option<Range<u64>> {
        self.root.leaf(leaf)
    }

    /// Reads the entries of a leaf page from its bytes, sorted by name.
    ///
    /// # Errors
    /// [`LibraryError::Invalid`] when the page breaks a rule.
    pub fn read_leaf(&self, leaf: usize, bytes: &[u8]) -> Result<Vec<Entry>, LibraryError> {
        Ok(self.leaf(leaf, bytes)?)
    }

    pub(crate) fn leaf(&self, leaf: usize, bytes: &[u8]) -> Result<Vec<Entry>, Fault> {
        let page = page::unpack(bytes, self.limits.leaf_bytes, &leaf_place(leaf))?;
        let reader =
            LeafReader { leaf, root: &self.root, header: &self.header, limits: &self.limits };
        reader.read(&page)
    }

    /// Returns the bytes in the file of which a texture is made: its own, and each object that it
    /// shares.
    pub fn asset_ranges(&self, entry: &Entry) -> Vec<Range<u64>> {
        let in_part = |part: &Range<u64>, range: &Range<u64>| {
            part.start.saturating_add(range.start)..part.start.saturating_add(range.end)
        };
        let own = in_part(&self.header.payload, &entry.place.own);
        let cuts = entry.place.cuts.iter();
        let shared = cuts.map(|cut| in_part(&self.header.shared, &cut.object));
        std::iter::once(own).chain(shared).collect()
    }

    /// Makes a texture of the bytes of its ranges, in the order of [`Self::asset_ranges`], and
    /// compares them with its hash.
    ///
    /// # Errors
    /// [`LibraryError::Invalid`] when the bytes are not those of the texture.
    pub fn assemble<B: AsRef<[u8]>>(
        &self,
        entry: &Entry,
        parts: &[B],
    ) -> Result<Vec<u8>, LibraryError> {
        let asset = assembled(entry, parts).unwrap_or_default();
        if blake3::hash(&asset).as_bytes() == &entry.blake3 {
            return Ok(asset);
        }
        Err(changed(entry, "").into())
    }
}

/// Puts shared objects among the texture's own bytes; `None` when a part is missing or has another
/// length.
pub(crate) fn assembled<B: AsRef<[u8]>>(entry: &Entry, parts: &[B]) -> Option<Vec<u8>> {
    let (own, objects) = parts.split_first()?;
    let (own, cuts) = (own.as_ref(), &entry.place.cuts);
    if cuts.is_empty() {
        return Some(own.to_vec());
    }
    let mut asset = Vec::with_capacity(usize::try_from(entry.bytes).ok()?);
    let mut at = 0;
    for (cut, object) in cuts.iter().zip(objects) {
        let next = usize::try_from(cut.at).ok()?;
        asset.extend_from_slice(own.get(at..next)?);
        asset.extend_from_slice(object.as_ref());
        at = next;
    }
    asset.extend_from_slice(own.get(at..)?);
    let is_complete = objects.len() == cuts.len() && asset.len() as u64 == entry.bytes;
    is_complete.then_some(asset)
}

/// The texture's bytes are not those of its hash.
pub(crate) fn changed(entry: &Entry, place: &str) -> Fault {
    let message = format!(
        "the bytes of {} do not have its hash {}; get the file again",
        entry.name,
        entry.blake3_hex()
    );
    Fault::new(rule::LIBRARY_ASSET_CHANGED, place, message)
}
