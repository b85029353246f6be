//! The index of an open library. The index does not read the file itself. It tells the caller where
//! pages and textures are in the file, and decodes the bytes that the caller has read.

use std::ops::Range;
use std::sync::OnceLock;

use htex_base::finding::{Finding, Findings};

use crate::library::coarse_spectrum::CoarseSpectrum;
use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::fault::{Fault, leaf_place, spectra_place};
use crate::library::header::{Header, newer_note};
use crate::library::leaf::LeafReader;
use crate::library::limits::Limits;
use crate::library::metadata::LibraryMetadata;
use crate::library::page;
use crate::library::ratio::Ratio;
use crate::library::root::Root;
use crate::library::rules as rule;
use crate::library::spectra::read_spectra;
use crate::signing::{PublicKey, SignedContent, Signers};

/// The header and the root page of an open library.
///
/// A texture is opened in three steps:
///
/// 1. [`Self::leaf_of`] finds the leaf page for the texture's name, and [`Self::leaf_range`]
///    returns the byte range of that page in the file.
/// 2. [`Self::read_leaf`] decodes the page. This page contains the texture's entry.
/// 3. [`Self::asset_ranges`] returns the ranges of the texture's bytes, and [`Self::assemble`]
///    assembles the texture from these bytes.
///
/// [`crate::library::Library`] does these steps and reads the bytes from a
/// [`crate::library::LibrarySource`].
#[derive(Debug, Clone)]
pub struct Index {
    header: Header,
    root: Root,
    /// BLAKE3 of the root page as it is in the file.
    root_blake3: [u8; 32],
    /// BLAKE3 of each leaf page as it is in the file, after [`Index::check_hash`].
    leaves_blake3: OnceLock<Vec<[u8; 32]>>,
    limits: Limits,
}

impl Index {
    pub(crate) fn new(header: Header, root: Root, root_blake3: [u8; 32], limits: Limits) -> Self {
        Self { header, root, root_blake3, leaves_blake3: OnceLock::new(), limits }
    }

    /// Compares the whole index with the hash that the header states. `read` returns the bytes of a
    /// range of the file; the ranges follow each other. From then on, [`Self::read_leaf`] refuses a
    /// page that differs, so that a file that changes later cannot pass for the one that was checked.
    ///
    /// # Errors
    /// Returns [`LibraryError::Invalid`] if the index does not have the hash, and the errors of
    /// `read`.
    pub fn check_hash(
        &self,
        mut read: impl FnMut(Range<u64>) -> Result<Vec<u8>, LibraryError>,
    ) -> Result<(), LibraryError> {
        if self.is_checked() {
            return Ok(());
        }
        let root = read(self.header.root.clone())?;
        let mut whole = blake3::Hasher::new();
        whole.update(&root);
        let mut leaves = Vec::new();
        for leaf in 0..self.leaves() {
            let page = read(self.leaf_range(leaf).unwrap_or_default())?;
            whole.update(&page);
            leaves.push(*blake3::hash(&page).as_bytes());
        }
        let is_opened_root = blake3::hash(&root).as_bytes() == &self.root_blake3;
        if !is_opened_root || whole.finalize().as_bytes() != &self.blake3() {
            return Err(Fault::index_changed().into());
        }
        // Another thread that was faster has kept the same hashes.
        let _ = self.leaves_blake3.set(leaves);
        Ok(())
    }

    /// Returns the byte range of the whole index in the file, which [`Self::check_hash`] reads.
    pub fn range(&self) -> Range<u64> {
        self.header.root.start..self.header.leaves.end
    }

    /// Returns whether [`Self::check_hash`] has succeeded.
    pub(crate) fn is_checked(&self) -> bool {
        self.leaves_blake3.get().is_some()
    }

    /// Returns the accepted key that signed the library. Compares the whole index with its hash, as
    /// [`Self::check_hash`] does. `signature` is the contents of the file with the signature, or
    /// `None` if there is none.
    ///
    /// # Errors
    /// Returns [`LibraryError::Signature`] if the library is not signed by one of `signers`, and the
    /// errors of [`Self::check_hash`].
    pub fn check_signed(
        &self,
        signature: Option<&[u8]>,
        signers: &Signers,
        read: impl FnMut(Range<u64>) -> Result<Vec<u8>, LibraryError>,
    ) -> Result<PublicKey, LibraryError> {
        // First what needs no reading.
        let key = signers.check(&SignedContent::index(self), signature)?;
        self.check_hash(read)?;
        Ok(key)
    }

    pub(crate) fn header(&self) -> &Header {
        &self.header
    }

    /// Returns the name of the library; it may be empty.
    pub fn name(&self) -> &str {
        &self.root.name
    }

    /// Returns the library's metadata, such as its version, description and authors.
    pub fn metadata(&self) -> &LibraryMetadata {
        &self.root.metadata
    }

    /// Returns the number of textures.
    #[allow(clippy::len_without_is_empty)] // The library has `is_empty`.
    pub fn len(&self) -> u64 {
        self.header.entries
    }

    /// Returns the BLAKE3 hash of the index. This hash identifies the library: two libraries with
    /// the same hash contain the same textures with the same names.
    pub fn blake3(&self) -> [u8; 32] {
        self.header.index_blake3
    }

    /// Returns the minor version of the library's format. An index of version 1.0 has no library
    /// metadata, and no licences, authors, quantities, felt differences, held-out errors or
    /// spectra.
    pub fn minor_version(&self) -> u16 {
        self.header.minor
    }

    /// Returns the size of the library's file, bytes.
    pub fn file_bytes(&self) -> u64 {
        self.header.payload.end
    }

    /// Returns all findings that are not errors, such as a newer minor version.
    pub fn notes(&self) -> Vec<Finding> {
        let mut findings = Findings::default();
        if let Some(note) = newer_note(self.header.minor) {
            note.add_to(&mut findings);
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

    /// Returns the number of the leaf page that may contain the entry with this name, or `None` if
    /// no page can contain it.
    pub fn leaf_of(&self, name: &str) -> Option<usize> {
        self.root.leaf_of(name.as_bytes())
    }

    /// Returns the byte range of a leaf page in the file; `None` if there is no such page.
    pub fn leaf_range(&self, leaf: usize) -> Option<Range<u64>> {
        self.root.leaf(leaf)
    }

    /// Returns where in the file the spectra for a leaf page are: the byte range of their page.
    /// Returns `None` if no entry of the leaf page has a spectrum.
    pub fn spectra_range(&self, leaf: usize) -> Option<Range<u64>> {
        self.root.spectra(leaf)
    }

    /// Decodes the spectra of a leaf page's entries from their bytes. The spectra are in the same
    /// order as the entries.
    ///
    /// # Errors
    /// Returns [`LibraryError::Invalid`] if the page breaks a rule.
    pub fn read_spectra(
        &self,
        leaf: usize,
        bytes: &[u8],
    ) -> Result<Vec<Option<CoarseSpectrum>>, LibraryError> {
        Ok(self.spectra(leaf, bytes)?)
    }

    pub(crate) fn spectra(
        &self,
        leaf: usize,
        bytes: &[u8],
    ) -> Result<Vec<Option<CoarseSpectrum>>, Fault> {
        let place = spectra_place(leaf);
        let page = page::unpack(bytes, self.limits.leaf_bytes, &place)?;
        read_spectra(&page).map_err(|m| Fault::page(&place, m))
    }

    pub(crate) fn spectra_blake3(&self) -> [u8; 32] {
        self.root.spectra_blake3
    }

    pub(crate) fn spectra_start(&self) -> u64 {
        self.root.spectra_start()
    }

    /// Decodes the entries of a leaf page from its bytes. The entries are sorted by name.
    ///
    /// # Errors
    /// Returns [`LibraryError::Invalid`] if the page breaks a rule.
    pub fn read_leaf(&self, leaf: usize, bytes: &[u8]) -> Result<Vec<Entry>, LibraryError> {
        Ok(self.leaf(leaf, bytes)?)
    }

    pub(crate) fn leaf(&self, leaf: usize, bytes: &[u8]) -> Result<Vec<Entry>, Fault> {
        let known = self.leaves_blake3.get().and_then(|leaves| leaves.get(leaf));
        if known.is_some_and(|known| blake3::hash(bytes).as_bytes() != known) {
            let message = "the page changed after the index was checked; open the library again";
            return Err(Fault::new(rule::LIBRARY_INDEX_CHANGED, leaf_place(leaf), message));
        }
        let page = page::unpack(bytes, self.limits.leaf_bytes, &leaf_place(leaf))?;
        let reader =
            LeafReader { leaf, root: &self.root, header: &self.header, limits: &self.limits };
        reader.read(&page)
    }

    /// Returns the ranges of the file that contain a texture's bytes: first the bytes that only
    /// this texture has, then each object that it shares with other textures.
    pub fn asset_ranges(&self, entry: &Entry) -> Vec<Range<u64>> {
        let in_part = |part: &Range<u64>, range: &Range<u64>| {
            part.start.saturating_add(range.start)..part.start.saturating_add(range.end)
        };
        let own = in_part(&self.header.payload, &entry.place.own);
        let cuts = entry.place.cuts.iter();
        let shared = cuts.map(|cut| in_part(&self.header.shared, &cut.object));
        std::iter::once(own).chain(shared).collect()
    }

    /// Assembles a texture from the bytes of its ranges, in the order of [`Self::asset_ranges`],
    /// and compares the result with the texture's hash.
    ///
    /// # Errors
    /// Returns [`LibraryError::Invalid`] if the bytes do not have the texture's hash.
    pub fn assemble<B: AsRef<[u8]>>(
        &self,
        entry: &Entry,
        parts: &[B],
    ) -> Result<Vec<u8>, LibraryError> {
        // If a part is missing, the hash of an empty file is compared. No texture has this hash, so
        // a missing part gives the same error as a changed part.
        let asset = assembled(entry, parts).unwrap_or_default();
        if blake3::hash(&asset).as_bytes() == &entry.blake3 {
            return Ok(asset);
        }
        Err(changed(entry, "").into())
    }
}

/// Inserts the shared objects into the texture's own bytes. Returns `None` if a part is missing or
/// has the wrong length.
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

/// Returns the fault for bytes that do not have the texture's hash.
pub(crate) fn changed(entry: &Entry, place: &str) -> Fault {
    let message = format!(
        "the bytes of {} do not have its hash {}; get the file again",
        entry.name,
        entry.blake3_hex()
    );
    Fault::new(rule::LIBRARY_ASSET_CHANGED, place, message)
}
