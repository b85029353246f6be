//! An open library, which reads textures on request.

use std::ops::Range;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use htex_base::finding::Finding;

use crate::library::coarse_spectrum::CoarseSpectrum;
use crate::library::description::Description;
use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::index::Index;
use crate::library::limits::Limits;
use crate::library::metadata::LibraryMetadata;
use crate::library::opening::{Opening, Progress};
use crate::library::ratio::Ratio;
use crate::library::source::{LibrarySource, LocalFile};
use crate::signing::{PublicKey, Signers};

/// When all entries are listed, at most this many bytes of the index are read at once.
const READ_AHEAD: u64 = 1 << 20;

/// Largest number of index pages that are searched for names similar to an absent name.
const MOST_SEARCHED: usize = 16;
/// Largest number of names that the error about an absent name suggests.
const MOST_SUGGESTED: usize = 3;

/// An open library of textures. The library reads the bytes of a texture only on request.
///
/// The library caches the page of the index that it used last. If the name of the next texture is
/// on the same page, opening that texture takes only one read. Threads can share a library.
///
/// ```no_run
/// let library = htex_format::library::Library::open("cloth.htexlib".as_ref())?;
/// println!("{}: {} textures", library.name(), library.len());
/// let bytes = library.get("woven/cotton")?; // a .htex file
/// # Ok::<(), htex_format::library::LibraryError>(())
/// ```
#[derive(Debug)]
pub struct Library<S = LocalFile> {
    source: S,
    index: Index,
    recent: Mutex<Option<Leaf>>,
    recent_spectra: Mutex<Option<Spectra>>,
}

/// The spectra of a leaf page's entries.
#[derive(Debug, Clone)]
struct Spectra {
    leaf: usize,
    spectra: Arc<Vec<Option<CoarseSpectrum>>>,
}

/// The entries of a leaf page.
#[derive(Debug, Clone)]
struct Leaf {
    number: usize,
    entries: Arc<Vec<Entry>>,
    /// Whether the page was compared with the hash of a checked index.
    is_checked: bool,
}

impl Library<LocalFile> {
    /// Opens a local file, within the default [`Limits`].
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or if its header or root page breaks a rule.
    pub fn open(path: &Path) -> Result<Self, LibraryError> {
        Self::open_source(LocalFile::open(path)?)
    }
}

impl<S: LibrarySource> Library<S> {
    /// Opens a library from any source, within the default [`Limits`].
    ///
    /// # Errors
    /// Returns the errors of [`Library::open`].
    pub fn open_source(source: S) -> Result<Self, LibraryError> {
        Self::open_source_with(source, Limits::default())
    }

    /// Opens a library from any source, within the given limits.
    ///
    /// # Errors
    /// Returns the errors of [`Library::open`].
    pub fn open_source_with(source: S, limits: Limits) -> Result<Self, LibraryError> {
        let mut opening = Opening::new(limits);
        loop {
            let wanted = opening.wanted();
            let bytes = read_up_to(&source, wanted.clone())?;
            let length = source.len().map_err(|error| failed(&wanted, error))?;
            match opening.give(&bytes, length)? {
                Progress::More(more) => opening = more,
                Progress::Open(index) => {
                    return Ok(Self {
                        source,
                        index,
                        recent: Mutex::default(),
                        recent_spectra: Mutex::default(),
                    });
                }
            }
        }
    }

    /// Returns where the bytes of the library come from.
    pub fn source(&self) -> &S {
        &self.source
    }

    /// Returns the name of the library; it may be empty.
    pub fn name(&self) -> &str {
        self.index.name()
    }

    /// Returns the library's metadata, such as its version and authors.
    pub fn metadata(&self) -> &LibraryMetadata {
        self.index.metadata()
    }

    /// Returns the number of textures.
    pub fn len(&self) -> u64 {
        self.index.len()
    }

    /// Returns whether the library has no textures.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns all findings that are not errors, such as a newer minor version.
    pub fn notes(&self) -> Vec<Finding> {
        self.index.notes()
    }

    /// Returns a counter that adds up the sizes of the textures that a program reads. The counter
    /// returns an error if the sum is too large for the size of the library's file, so that a small
    /// file cannot unpack to a huge folder.
    ///
    /// ```no_run
    /// let library = htex_format::library::Library::open("cloth.htexlib".as_ref())?;
    /// let mut ratio = library.ratio();
    /// for entry in library.entries() {
    ///     let entry = entry?;
    ///     ratio.add(&entry)?;
    ///     let bytes = library.read(&entry)?;
    /// }
    /// # Ok::<(), htex_format::library::LibraryError>(())
    /// ```
    pub fn ratio(&self) -> Ratio {
        self.index.ratio()
    }

    pub fn index(&self) -> &Index {
        &self.index
    }

    /// Reads a texture by name. Returns the bytes of the texture's `.htex` file, after checking
    /// their hash.
    ///
    /// # Errors
    /// Returns [`LibraryError::Absent`] if there is no such texture, or another error if bytes
    /// cannot be read or break a rule.
    pub fn get(&self, name: &str) -> Result<Vec<u8>, LibraryError> {
        self.read(&self.needed(name)?)
    }

    /// Reads the entry of a texture, and returns an error if the library does not have the texture.
    ///
    /// # Errors
    /// Returns the errors of [`Self::get`].
    pub fn needed(&self, name: &str) -> Result<Entry, LibraryError> {
        let absent = || LibraryError::Absent { name: name.to_owned(), nearest: self.nearest(name) };
        self.entry(name)?.ok_or_else(absent)
    }

    /// Returns the most similar names, for an error. In a large library, considers only the page
    /// that would list the name.
    fn nearest(&self, name: &str) -> Vec<String> {
        let leaves = match self.index.leaf_of(name) {
            _ if self.index.leaves() <= MOST_SEARCHED => 0..self.index.leaves(),
            Some(leaf) => leaf..leaf + 1,
            None => 0..0,
        };
        // Pages that cannot be read are left out.
        let pages = leaves.filter_map(|leaf| self.leaf(leaf).ok());
        let names: Vec<String> = pages
            .flat_map(|page| page.iter().map(|e| e.name.clone()).collect::<Vec<_>>())
            .collect();
        htex_base::similar(name, names.iter().map(String::as_str), MOST_SUGGESTED)
            .into_iter()
            .map(str::to_owned)
            .collect()
    }

    /// Reads the entry of a texture. Returns `None` if there is no such texture.
    ///
    /// # Errors
    /// Returns an error if the page of the index cannot be read or breaks a rule.
    pub fn entry(&self, name: &str) -> Result<Option<Entry>, LibraryError> {
        let Some(leaf) = self.index.leaf_of(name) else {
            return Ok(None);
        };
        let entries = self.leaf(leaf)?;
        let found = entries.binary_search_by(|entry| entry.name.as_str().cmp(name));
        Ok(found.ok().map(|i| entries[i].clone()))
    }

    /// Reads the entries of a leaf page of the index, sorted by name. `leaf` counts the pages
    /// from 0. Returns `None` if there is no such page.
    ///
    /// # Errors
    /// Returns an error if the page cannot be read or breaks a rule.
    pub fn leaf_entries(&self, leaf: usize) -> Result<Option<Arc<Vec<Entry>>>, LibraryError> {
        if leaf >= self.index.leaves() {
            return Ok(None);
        }
        self.leaf(leaf).map(Some)
    }

    /// Reads the texture of an entry. The entry must come from this library.
    ///
    /// # Errors
    /// Returns the errors of [`Self::get`].
    pub fn read(&self, entry: &Entry) -> Result<Vec<u8>, LibraryError> {
        let ranges = self.index.asset_ranges(entry).into_iter();
        let parts: Result<Vec<_>, _> = ranges.map(|range| self.read_range(range)).collect();
        self.index.assemble(entry, &parts?)
    }

    /// Reads a texture's description: values for searches, in addition to the facts in the
    /// texture's manifest. The entry must come from this library. One page of spectra contains the
    /// spectra of all entries of a leaf page. The function reads this page unless it is in the
    /// cache.
    ///
    /// # Errors
    /// Returns an error if the page of spectra cannot be read or breaks a rule.
    pub fn description(&self, entry: &Entry) -> Result<Description, LibraryError> {
        let spectra = self.spectra(entry.place.leaf)?;
        Ok(Description {
            spectrum: spectra.get(entry.place.row).copied().flatten(),
            felt_error_rms_db: entry.felt_error_rms_db,
            held_out_error_db: entry.held_out_error_db,
        })
    }

    /// Returns the spectra of a leaf page's entries; no spectra if the page has none.
    fn spectra(&self, leaf: usize) -> Result<Arc<Vec<Option<CoarseSpectrum>>>, LibraryError> {
        let Some(range) = self.index.spectra_range(leaf) else { return Ok(Arc::default()) };
        let recent = || self.recent_spectra.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = recent().as_ref().filter(|known| known.leaf == leaf) {
            return Ok(known.spectra.clone());
        }
        let spectra = Arc::new(self.index.read_spectra(leaf, &self.read_range(range)?)?);
        *recent() = Some(Spectra { leaf, spectra: spectra.clone() });
        Ok(spectra)
    }

    /// Returns all entries, sorted by name. One read covers many pages. The iterator decodes a page
    /// when it reaches the page's first entry.
    pub fn entries(&self) -> Entries<'_, S> {
        let ahead = Ahead::default();
        Entries { library: self, next_leaf: 0, entries: Arc::default(), next: 0, ahead }
    }

    /// Returns all entries with their descriptions, sorted by name. One read covers many pages.
    pub fn described(&self) -> Described<'_, S> {
        let (entries, ahead) = (self.entries(), Ahead::default());
        Described { entries, ahead, spectra: Vec::new(), leaf: None }
    }

    /// Returns the entries of a leaf page. Reads the page unless it is the page in the cache.
    fn leaf(&self, number: usize) -> Result<Arc<Vec<Entry>>, LibraryError> {
        // The lock is not held while a page is read, so that threads do not wait for each other's
        // requests. Pages are replaced as a whole. Therefore, a thread that panics cannot leave an
        // incomplete page in the cache.
        let recent = || self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        // A page that was read before the index was checked is read again.
        let is_checked = self.index.is_checked();
        let is_known = |leaf: &&Leaf| leaf.number == number && (leaf.is_checked || !is_checked);
        if let Some(leaf) = recent().as_ref().filter(is_known) {
            return Ok(leaf.entries.clone());
        }
        let range = self.index.leaf_range(number).unwrap_or_default();
        let bytes = self.read_range(range)?;
        let entries = Arc::new(self.index.read_leaf(number, &bytes)?);
        *recent() = Some(Leaf { number, entries: entries.clone(), is_checked });
        Ok(entries)
    }

    /// Compares the whole index with the hash that the header states.
    pub(crate) fn check_index(&self) -> Result<(), LibraryError> {
        self.index.check_hash(self.index_reader())
    }

    /// Returns the accepted key that signed the library. `signature` is the contents of the file with
    /// the signature, or `None` without such a file. Reads the whole index. From then on, the library
    /// reads only textures that the signature covers: their hashes are in the index.
    ///
    /// # Errors
    /// Returns [`LibraryError::Signature`] if the library is not signed by one of `signers`. Returns
    /// another error if the index cannot be read or does not have the hash that was signed.
    pub fn check_signed(
        &self,
        signature: Option<&[u8]>,
        signers: &Signers,
    ) -> Result<PublicKey, LibraryError> {
        self.index.check_signed(signature, signers, self.index_reader())
    }

    /// Returns a function that reads the pages of the index, many at once.
    fn index_reader(&self) -> impl FnMut(Range<u64>) -> Result<Vec<u8>, LibraryError> {
        let mut ahead = Ahead::default();
        let end = self.index.header().leaves.end;
        move |page| {
            if ahead.get(&page).is_none() {
                let to = page.start.saturating_add(READ_AHEAD).min(end).max(page.end);
                ahead = Ahead { start: page.start, bytes: self.read_range(page.start..to)? };
            }
            Ok(ahead.get(&page).unwrap_or_default().to_vec())
        }
    }

    pub(crate) fn read_range(&self, range: Range<u64>) -> Result<Vec<u8>, LibraryError> {
        let bytes = read_up_to(&self.source, range.clone())?;
        if bytes.len() as u64 == range.end - range.start {
            return Ok(bytes);
        }
        let error = std::io::Error::new(
            std::io::ErrorKind::UnexpectedEof,
            "the file ends within them; it changed while it was read",
        );
        Err(failed(&range, error))
    }
}

/// Reads a range, or fewer bytes at the end of the file. The range is within the limits, because a
/// library checks all its ranges when it is opened.
fn read_up_to(source: &impl LibrarySource, range: Range<u64>) -> Result<Vec<u8>, LibraryError> {
    let length = usize::try_from(range.end - range.start)
        .map_err(|error| failed(&range, std::io::Error::other(error)))?;
    let mut bytes = vec![0; length];
    if length > 0 {
        let count =
            source.read_at(range.start, &mut bytes).map_err(|error| failed(&range, error))?;
        bytes.truncate(count);
    }
    Ok(bytes)
}

fn failed(range: &Range<u64>, error: std::io::Error) -> LibraryError {
    LibraryError::Read { at: range.start, length: range.end - range.start, error }
}

/// The entries of a library, sorted by name. The iterator ends after an error.
#[derive(Debug)]
pub struct Entries<'a, S = LocalFile> {
    library: &'a Library<S>,
    next_leaf: usize,
    entries: Arc<Vec<Entry>>,
    next: usize,
    ahead: Ahead,
}

/// Bytes of the index that were read at once.
#[derive(Debug, Default)]
struct Ahead {
    /// Offset in the file.
    start: u64,
    bytes: Vec<u8>,
}

impl Ahead {
    fn get(&self, range: &Range<u64>) -> Option<&[u8]> {
        let from = range.start.checked_sub(self.start)?;
        let to = range.end.checked_sub(self.start)?;
        self.bytes.get(usize::try_from(from).ok()?..usize::try_from(to).ok()?)
    }
}

impl<S: LibrarySource> Library<S> {
    /// Returns the bytes of a page. Also reads the pages after it. `range` returns the place of
    /// each page in the file. The pages follow each other, and pages without a place are skipped.
    fn page<'a>(
        &self,
        ahead: &'a mut Ahead,
        number: usize,
        range: impl Fn(usize) -> Option<Range<u64>>,
    ) -> Result<&'a [u8], LibraryError> {
        let page = range(number).unwrap_or_default();
        if ahead.get(&page).is_none() {
            let ranges = (number + 1..self.index.leaves()).filter_map(range);
            let ends = ranges.map(|range| range.end);
            let end = ends.take_while(|end| end - page.start <= READ_AHEAD).last();
            let all = page.start..end.unwrap_or(page.end);
            *ahead = Ahead { start: all.start, bytes: self.read_range(all)? };
        }
        Ok(ahead.get(&page).unwrap_or_default())
    }
}

impl<S: LibrarySource> Entries<'_, S> {
    /// Returns the entries of a leaf page. Also reads the pages after it.
    fn leaf(&mut self, number: usize) -> Result<Arc<Vec<Entry>>, LibraryError> {
        let index = &self.library.index;
        let page = self.library.page(&mut self.ahead, number, |leaf| index.leaf_range(leaf))?;
        index.read_leaf(number, page).map(Arc::new)
    }
}

/// The entries of a library with their descriptions, sorted by name. The iterator ends after an
/// error.
#[derive(Debug)]
pub struct Described<'a, S = LocalFile> {
    entries: Entries<'a, S>,
    ahead: Ahead,
    spectra: Vec<Option<CoarseSpectrum>>,
    /// The leaf of these spectra.
    leaf: Option<usize>,
}

impl<S: LibrarySource> Described<'_, S> {
    fn description(&mut self, entry: &Entry) -> Result<Description, LibraryError> {
        let (library, leaf) = (self.entries.library, entry.place.leaf);
        if self.leaf != Some(leaf) {
            let index = &library.index;
            self.spectra = match index.spectra_range(leaf) {
                Some(_) => {
                    let range = |leaf| index.spectra_range(leaf);
                    index.read_spectra(leaf, library.page(&mut self.ahead, leaf, range)?)?
                }
                None => Vec::new(),
            };
            self.leaf = Some(leaf);
        }
        Ok(Description {
            spectrum: self.spectra.get(entry.place.row).copied().flatten(),
            felt_error_rms_db: entry.felt_error_rms_db,
            held_out_error_db: entry.held_out_error_db,
        })
    }
}

impl<S: LibrarySource> Iterator for Described<'_, S> {
    type Item = Result<(Entry, Description), LibraryError>;

    fn next(&mut self) -> Option<Self::Item> {
        let entry = match self.entries.next()? {
            Ok(entry) => entry,
            Err(error) => return Some(Err(error)),
        };
        let described = self.description(&entry);
        if described.is_err() {
            self.entries.next_leaf = self.entries.library.index.leaves();
            self.entries.next = self.entries.entries.len();
        }
        Some(described.map(|description| (entry, description)))
    }
}

impl<S: LibrarySource> Iterator for Entries<'_, S> {
    type Item = Result<Entry, LibraryError>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.next == self.entries.len() {
            if self.next_leaf == self.library.index.leaves() {
                return None;
            }
            match self.leaf(self.next_leaf) {
                Ok(entries) => (self.entries, self.next) = (entries, 0),
                Err(error) => {
                    (self.entries, self.next) = (Arc::default(), 0);
                    // This ends the iteration.
                    self.next_leaf = self.library.index.leaves();
                    return Some(Err(error));
                }
            }
            self.next_leaf += 1;
        }
        self.next += 1;
        Some(Ok(self.entries[self.next - 1].clone()))
    }
}
