//! Reads many textures with a few large read operations.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, mpsc};

use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::reader::Library;
use crate::library::source::LibrarySource;

/// If two textures or pages are at most this many bytes apart in the file, they are read at once. A
/// common connection transfers about this many bytes in the time that a request to a distant server
/// takes.
const MOST_GAP: u64 = 256 << 10;
/// Largest read, bytes, of several textures or pages.
const MOST_READ: u64 = 8 << 20;

/// Ranges that are read at once, and the range that covers them.
struct Run {
    all: Range<u64>,
    /// Indices of the ranges.
    members: Vec<usize>,
}

/// Joins ranges that are near each other.
fn runs(ranges: &[Range<u64>]) -> Vec<Run> {
    let mut order: Vec<usize> = (0..ranges.len()).collect();
    order.sort_by_key(|i| ranges[*i].start);
    let mut runs: Vec<Run> = Vec::new();
    for i in order {
        let range = &ranges[i];
        match runs.last_mut() {
            Some(run)
                if range.start <= run.all.end.saturating_add(MOST_GAP)
                    && range.end.saturating_sub(run.all.start) <= MOST_READ =>
            {
                run.all.end = run.all.end.max(range.end);
                run.members.push(i);
            }
            _ => runs.push(Run { all: range.clone(), members: vec![i] }),
        }
    }
    runs
}

fn part<'a>(run: &Run, bytes: &'a [u8], range: &Range<u64>) -> &'a [u8] {
    let at = |x: u64| usize::try_from(x - run.all.start).unwrap_or(usize::MAX);
    bytes.get(at(range.start)..at(range.end)).unwrap_or_default()
}

impl<S: LibrarySource + Sync> Library<S> {
    /// Reads the entries of these textures, in the order in which `names` lists them. One read
    /// covers several neighbouring pages, and up to `at_once` reads run at the same time. This
    /// saves time if the library is on a network.
    ///
    /// # Errors
    /// Returns the errors of [`Self::get`]. Also returns an error if the library lacks one of the
    /// names.
    pub fn entries_of<N: AsRef<str>>(
        &self,
        names: &[N],
        at_once: usize,
    ) -> Result<Vec<Entry>, LibraryError> {
        let leaves = names.iter().filter_map(|name| self.index().leaf_of(name.as_ref()));
        let mut leaves: Vec<usize> = leaves.collect();
        leaves.sort_unstable();
        leaves.dedup();
        let ranges: Vec<Range<u64>> =
            leaves.iter().map(|leaf| self.index().leaf_range(*leaf).unwrap_or_default()).collect();
        let mut found: BTreeMap<String, Entry> = BTreeMap::new();
        self.read_runs(&ranges, at_once, |i, bytes| {
            for entry in self.index().read_leaf(leaves[i], bytes)? {
                found.insert(entry.name.clone(), entry);
            }
            Ok::<(), LibraryError>(())
        })?;
        names
            .iter()
            .map(|name| match found.get(name.as_ref()) {
                Some(entry) => Ok(entry.clone()),
                None => self.needed(name.as_ref()),
            })
            .collect()
    }

    /// Reads the textures of entries, which must come from this library. One read covers several
    /// textures that are near each other in the file, and `at_once` reads run at the same time.
    /// `take` receives each texture once. The textures arrive in the order of the file or, if
    /// `at_once` is above 1, in the order in which the reads end.
    ///
    /// ```no_run
    /// let library = htex_format::library::Library::open("cloth.htexlib".as_ref())?;
    /// let entries = library.entries_of(&["wood/oak", "wood/elm"], 1)?;
    /// library.read_many(&entries, 1, |entry, bytes| {
    ///     println!("{}: {} bytes", entry.name, bytes.len());
    ///     Ok::<(), htex_format::library::LibraryError>(())
    /// })?;
    /// # Ok::<(), htex_format::library::LibraryError>(())
    /// ```
    ///
    /// # Errors
    /// Returns the first error of [`Self::read`] or of `take`. This error ends the reading.
    pub fn read_many<E: From<LibraryError>>(
        &self,
        entries: &[Entry],
        at_once: usize,
        mut take: impl FnMut(&Entry, Vec<u8>) -> Result<(), E>,
    ) -> Result<(), E> {
        let all: Vec<Vec<Range<u64>>> =
            entries.iter().map(|entry| self.index().asset_ranges(entry)).collect();
        let own: Vec<Range<u64>> =
            all.iter().filter_map(|ranges| ranges.first().cloned()).collect();
        // There are only few objects, and many textures share them.
        let mut objects: HashMap<Range<u64>, Arc<Vec<u8>>> = HashMap::new();
        for range in all.iter().flat_map(|ranges| &ranges[1..]) {
            objects.entry(range.clone()).or_default();
        }
        let shared: Vec<Range<u64>> = objects.keys().cloned().collect();
        self.read_runs(&shared, at_once, |i, bytes| {
            objects.insert(shared[i].clone(), Arc::new(bytes.to_vec()));
            Ok::<(), E>(())
        })?;
        self.read_runs(&own, at_once, |i, bytes| {
            let none = Arc::default();
            let shared = all[i][1..].iter();
            let shared: Vec<&[u8]> =
                shared.map(|range| objects.get(range).unwrap_or(&none).as_slice()).collect();
            let parts: Vec<&[u8]> = std::iter::once(bytes).chain(shared).collect();
            take(&entries[i], self.index().assemble(&entries[i], &parts)?)
        })
    }

    /// Reads ranges. `take` receives the index of each range and its bytes.
    fn read_runs<E: From<LibraryError>>(
        &self,
        ranges: &[Range<u64>],
        at_once: usize,
        mut take: impl FnMut(usize, &[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        let runs = runs(ranges);
        let mut taken = |run: &Run, bytes: &[u8]| {
            run.members.iter().try_for_each(|i| take(*i, part(run, bytes, &ranges[*i])))
        };
        if at_once < 2 || runs.len() < 2 {
            for run in &runs {
                taken(run, &self.read_range(run.all.clone())?)?;
            }
            return Ok(());
        }
        let next = AtomicUsize::new(0);
        let (sender, receiver) = mpsc::sync_channel(at_once);
        std::thread::scope(|scope| {
            for _ in 0..at_once.min(runs.len()) {
                let (sender, next, runs) = (sender.clone(), &next, &runs);
                scope.spawn(move || {
                    while let Some(run) = runs.get(next.fetch_add(1, Ordering::Relaxed)) {
                        if sender.send((run, self.read_range(run.all.clone()))).is_err() {
                            return;
                        }
                    }
                });
            }
            drop(sender);
            // If this loop ends early, the receiver is dropped, which ends the threads.
            for (run, bytes) in receiver {
                taken(run, &bytes?)?;
            }
            Ok(())
        })
    }
}
