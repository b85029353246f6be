//! Compares two libraries by the names and hashes of their textures.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::reader::{Entries, Library};
use crate::library::source::LibrarySource;

/// The textures that differ between two libraries, each list sorted by name.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LibraryDifference {
    /// Textures that only the first library has.
    pub removed: Vec<Entry>,
    /// Textures that only the second library has.
    pub added: Vec<Entry>,
    /// Textures with the same bytes but another name in the second library; see
    /// [`Self::find_renamed`].
    pub renamed: Vec<(Entry, Entry)>,
    /// Textures that have the same name in both libraries, but different bytes.
    pub changed: Vec<(Entry, Entry)>,
}

impl LibraryDifference {
    /// Compares two libraries. Reads no page if the indexes of both libraries have the same hash.
    /// `of_a` converts an error of the first library, and `of_b` an error of the second library.
    ///
    /// ```no_run
    /// use htex_format::library::{Library, LibraryDifference};
    /// let (old, new) = (Library::open("old.htexlib".as_ref())?, Library::open("new.htexlib".as_ref())?);
    /// let difference = LibraryDifference::between(&old, &new, |error| error, |error| error)?;
    /// for entry in difference.find_renamed().added {
    ///     println!("+ {}", entry.name);
    /// }
    /// # Ok::<(), htex_format::library::LibraryError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if a page of an index cannot be read or breaks a rule.
    pub fn between<A: LibrarySource, B: LibrarySource, E>(
        a: &Library<A>,
        b: &Library<B>,
        of_a: impl Fn(LibraryError) -> E,
        of_b: impl Fn(LibraryError) -> E,
    ) -> Result<Self, E> {
        let mut found = Self::default();
        if a.index().blake3() == b.index().blake3() {
            return Ok(found);
        }
        let mut a = Walk::new(a, of_a)?;
        let mut b = Walk::new(b, of_b)?;
        loop {
            let order = match (&a.next, &b.next) {
                (None, None) => return Ok(found),
                (Some(_), None) => Ordering::Less,
                (None, Some(_)) => Ordering::Greater,
                (Some(a), Some(b)) => a.name.cmp(&b.name),
            };
            // A library may have any number of entries. Therefore, only one entry of each library
            // and the entries that differ are in memory.
            let ours = if order.is_le() { a.step()? } else { None };
            let theirs = if order.is_ge() { b.step()? } else { None };
            match (ours, theirs) {
                (Some(a), Some(b)) if a.blake3 != b.blake3 => found.changed.push((a, b)),
                (Some(a), None) => found.removed.push(a),
                (None, Some(b)) => found.added.push(b),
                _ => {}
            }
        }
    }

    /// Finds renamed textures: a removed texture and an added texture with the same bytes.
    #[must_use]
    pub fn find_renamed(self) -> Self {
        let mut added: BTreeMap<[u8; 32], Vec<Entry>> = BTreeMap::new();
        // The order is reversed, because `pop` takes the last element. In this way the first
        // removed name is paired with the first added name.
        for entry in self.added.into_iter().rev() {
            added.entry(entry.blake3).or_default().push(entry);
        }
        let (mut removed, mut renamed) = (Vec::new(), self.renamed);
        for entry in self.removed {
            match added.get_mut(&entry.blake3).and_then(Vec::pop) {
                Some(to) => renamed.push((entry, to)),
                None => removed.push(entry),
            }
        }
        let mut added: Vec<Entry> = added.into_values().flatten().collect();
        added.sort_unstable_by(|a, b| a.name.cmp(&b.name));
        Self { removed, added, renamed, changed: self.changed }
    }

    /// Returns whether nothing differs.
    pub fn is_empty(&self) -> bool {
        self.removed.is_empty()
            && self.added.is_empty()
            && self.renamed.is_empty()
            && self.changed.is_empty()
    }
}

/// An iterator over a library's entries that also shows the next entry before it is taken.
struct Walk<'a, S, F> {
    entries: Entries<'a, S>,
    next: Option<Entry>,
    failed: F,
}

impl<'a, S: LibrarySource, E, F: Fn(LibraryError) -> E> Walk<'a, S, F> {
    fn new(library: &'a Library<S>, failed: F) -> Result<Self, E> {
        let mut walk = Self { entries: library.entries(), next: None, failed };
        walk.step()?;
        Ok(walk)
    }

    /// Takes the next entry.
    fn step(&mut self) -> Result<Option<Entry>, E> {
        let next = self.entries.next().transpose().map_err(&self.failed)?;
        Ok(std::mem::replace(&mut self.next, next))
    }
}
