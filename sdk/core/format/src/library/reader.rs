//! An open library, which reads textures on request.

use std::ops::Range;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use htex_base::finding::Finding;

use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::index::Index;
use crate::library::limits::Limits;
use crate::library::opening::{Opening, Progress};
use crate::library::ratio::Ratio;
use crate::library::source::{LibrarySource, LocalFile};

/// Largest number of bytes of the index that are read at once when all entries are listed.
const READ_AHEAD: u64 = 1 << 20;

/// Pages of the index that are searched for names similar to an absent one.
const MOST_SEARCHED: usize = 16;
/// Names that the error about an absent one suggests.
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
}

/// The entries of a leaf page.
#[derive(Debug, Clone)]
struct Leaf {
    number: usize,
    entries: Arc<Vec<Entry>>,
}

impl Library<LocalFile> {
    /// Opens a local file, within the default [`Limits`].
    ///
    /// # Errors
    /// If the file cannot be read, or its header or root page breaks a rule.
    pub fn open(path: &Path) -> Result<Self, LibraryError> {
        Self::open_source(LocalFile::open(path)?)
    }
}

impl<S: LibrarySource> Library<S> {
    /// Opens a library from any source, within the default [`Limits`].
    ///
    /// # Errors
    /// The errors of [`Library::open`].
    pub fn open_source(source: S) -> Result<Self, LibraryError> {
        Self::open_source_with(source, Limits::default())
    }

    /// Opens a library from any source, within the given limits.
    ///
    /// # Errors
    /// The errors of [`Library::open`].
    pub fn open_source_with(source: S, limits: Limits) -> Result<Self, LibraryError> {
        let mut opening = Opening::new(limits);
        loop {
            let wanted = opening.wanted();
            let bytes = read_up_to(&source, wanted.clone())?;
            let length = source.len().map_err(|error| failed(&wanted, error))?;
            match opening.give(&bytes, length)? {
                Progress::More(more) => opening = more,
                Progress::Open(index) => {
                    return Ok(Self { source, index, recent: Mutex::new(None) });
                }
            }
        }
    }

    /// Returns the name of the library; it may be empty.
    pub fn name(&self) -> &str {
        self.index.name()
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

    /// Returns a counter for programs that read many textures. The counter makes sure that a small
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
    /// [`LibraryError::Absent`] if there is no such texture, or another error if bytes cannot be
    /// read or break a rule.
    pub fn get(&self, name: &str) -> Result<Vec<u8>, LibraryError> {
        self.read(&self.needed(name)?)
    }

    /// Reads the entry of a texture that the library should have.
    ///
    /// # Errors
    /// The errors of [`Self::get`].
    pub fn needed(&self, name: &str) -> Result<Entry, LibraryError> {
        let absent = || LibraryError::Absent { name: name.to_owned(), nearest: self.nearest(name) };
        self.entry(name)?.ok_or_else(absent)
    }

    /// Returns the most similar names, for an error. In a large library, looks only at the page
    /// that would list the name.
    fn nearest(&self, name: &str) -> Vec<String> {
        let leaves = match self.index.leaf_of(name) {
            _ if self.index.leaves() <= MOST_SEARCHED => 0..self.index.leaves(),
            Some(leaf) => leaf..leaf + 1,
            None => 0..0,
        };
        // What cannot be read is not suggested.
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
    /// If the page cannot be read or breaks a rule.
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
    /// If the page cannot be read or breaks a rule.
    pub fn leaf_entries(&self, leaf: usize) -> Result<Option<Arc<Vec<Entry>>>, LibraryError> {
        if leaf >= self.index.leaves() {
            return Ok(None);
        }
        self.leaf(leaf).map(Some)
    }

    /// Reads the texture of an entry, which must come from this library.
    ///
    /// # Errors
    /// The errors of [`Self::get`].
    pub fn read(&self, entry: &Entry) -> Result<Vec<u8>, LibraryError> {
        let ranges = self.index.asset_ranges(entry).into_iter();
        let parts: Result<Vec<_>, _> = ranges.map(|range| self.read_range(range)).collect();
        self.index.assemble(entry, &parts?)
    }

    /// Returns all entries, sorted by name. Many pages are read at once, and decoded one at a time.
    pub fn entries(&self) -> Entries<'_, S> {
        let ahead = Ahead { start: 0, bytes: Vec::new() };
        Entries { library: self, next_leaf: 0, entries: Arc::default(), next: 0, ahead }
    }

    /// Returns the entries of a leaf page. Reads the page unless it is the page in the cache.
    fn leaf(&self, number: usize) -> Result<Arc<Vec<Entry>>, LibraryError> {
        // The lock is not held while a page is read, so that threads do not wait for each other's
        // requests. A thread that panics cannot leave half a page here, because pages are replaced
        // as a whole.
        let recent = || self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(leaf) = recent().as_ref().filter(|leaf| leaf.number == number) {
            return Ok(leaf.entries.clone());
        }
        let range = self.index.leaf_range(number).unwrap_or_default();
        let bytes = self.read_range(range)?;
        let entries = Arc::new(self.index.read_leaf(number, &bytes)?);
        *recent() = Some(Leaf { number, entries: entries.clone() });
        Ok(entries)
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
#[derive(Debug)]
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

impl<S: LibrarySource> Entries<'_, S> {
    /// Returns the entries of a leaf page. Reads the pages after it, too.
    fn leaf(&mut self, number: usize) -> Result<Arc<Vec<Entry>>, LibraryError> {
        let index = &self.library.index;
        let range = index.leaf_range(number).unwrap_or_default();
        if self.ahead.get(&range).is_none() {
            let ranges = (number + 1..).map_while(|next| index.leaf_range(next));
            let ends = ranges.map(|range| range.end);
            let end = ends.take_while(|end| end - range.start <= READ_AHEAD).last();
            let range = range.start..end.unwrap_or(range.end);
            self.ahead =
                Ahead { start: range.start, bytes: self.library.read_range(range.clone())? };
        }
        let page = self.ahead.get(&range).unwrap_or_default();
        index.read_leaf(number, page).map(Arc::new)
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
