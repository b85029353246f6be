//! Validates a whole library: every page of the index, and every texture.

use std::collections::BTreeMap;
use std::path::Path;

use crate::Asset;
use htex_base::finding::{Findings, Report};

use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::facts::Facts;
use crate::library::fault::Fault;
use crate::library::fault::{entry_place, spectra_place};
use crate::library::header::{MINOR, newer_note};
use crate::library::index::{assembled, changed};
use crate::library::leaf::length;
use crate::library::limits::Limits;
use crate::library::name::Names;
use crate::library::ratio::Ratio;
use crate::library::reader::Library;
use crate::library::rules as rule;
use crate::library::source::{LibrarySource, LocalFile};

/// Validates a library file within the default limits: every page of the index, and every texture
/// with [`crate::validate`].
///
/// # Errors
/// Returns an error if the file cannot be read. Problems in the file's contents are findings in the
/// report, not errors.
pub fn validate(path: &Path) -> Result<Report, LibraryError> {
    validate_source(LocalFile::open(path)?, &Limits::default())
}

/// Validates a library from any source, within the given limits.
///
/// # Errors
/// Returns the errors of [`validate`].
pub fn validate_source(
    source: impl LibrarySource,
    limits: &Limits,
) -> Result<Report, LibraryError> {
    let library = match Library::open_source_with(source, *limits) {
        Ok(library) => library,
        Err(LibraryError::Invalid { findings }) => {
            return Ok(Report::new(findings));
        }
        Err(error) => return Err(error),
    };
    let mut validation = Validation::new(&library, limits);
    if let Some(note) = newer_note(library.index().header().minor) {
        note.add_to(&mut validation.findings);
    }
    validation.run()?;
    Ok(Report::new(validation.findings.into_list()))
}

/// State of a validation.
struct Validation<'a, S> {
    library: &'a Library<S>,
    limits: &'a Limits,
    findings: Findings,
    /// Offset at which the next texture's own bytes must start; `None` after a leaf that could not
    /// be read.
    next: Option<u64>,
    /// Shared objects seen so far: the start of each object and its end.
    objects: BTreeMap<u64, u64>,
    /// Names seen so far, as 128-bit hashes that ignore case.
    names: Names,
    entries: u64,
    /// Counts the bytes of all textures so far.
    ratio: Ratio,
    /// Whether all leaves could be read.
    is_whole: bool,
    /// Number of entries of each leaf; `None` for a leaf that could not be read.
    leaf_entries: Vec<Option<usize>>,
}

impl<'a, S: LibrarySource> Validation<'a, S> {
    fn new(library: &'a Library<S>, limits: &'a Limits) -> Self {
        Self {
            library,
            limits,
            findings: Findings::default(),
            next: Some(0),
            objects: BTreeMap::new(),
            names: Names::default(),
            entries: 0,
            ratio: library.ratio(),
            is_whole: true,
            leaf_entries: Vec::new(),
        }
    }

    fn run(&mut self) -> Result<(), LibraryError> {
        let index = self.library.index();
        let mut hash = blake3::Hasher::new();
        hash.update(&self.library.read_range(index.header().root.clone())?);
        for leaf in 0..index.leaves() {
            let range = index.leaf_range(leaf).unwrap_or_default();
            let bytes = self.library.read_range(range)?;
            hash.update(&bytes);
            let read = index.leaf(leaf, &bytes);
            self.leaf_entries.push(read.as_ref().ok().map(Vec::len));
            match read {
                Ok(entries) => {
                    if !self.check_leaf(leaf, &entries)? {
                        return Ok(());
                    }
                }
                Err(fault) => {
                    fault.add_to(&mut self.findings);
                    // The next leaf can still be checked. But the place where its first texture
                    // must begin cannot be checked, and no total can be.
                    (self.next, self.is_whole) = (None, false);
                }
            }
        }
        if hash.finalize().as_bytes() != &index.blake3() {
            Fault::index_changed().add_to(&mut self.findings);
        }
        self.check_spectra()?;
        self.check_end();
        Ok(())
    }

    /// Checks the pages of spectra. The function does not check whether a spectrum belongs to its
    /// texture, because such a check would need the texture's model.
    fn check_spectra(&mut self) -> Result<(), LibraryError> {
        let index = self.library.index();
        let mut hash = blake3::Hasher::new();
        for leaf in 0..index.leaves() {
            let Some(range) = index.spectra_range(leaf) else { continue };
            let bytes = self.library.read_range(range)?;
            hash.update(&bytes);
            match index.spectra(leaf, &bytes) {
                Ok(spectra) => {
                    let entries = self.leaf_entries.get(leaf).copied().flatten();
                    let is_same = entries.is_none_or(|entries| entries == spectra.len());
                    self.findings.require(
                        is_same,
                        rule::LIBRARY_COUNT_WRONG,
                        spectra_place(leaf),
                        || {
                            format!(
                                "there are {} spectra and {} textures; pack the library again",
                                spectra.len(),
                                entries.unwrap_or_default()
                            )
                        },
                    );
                }
                Err(fault) => fault.add_to(&mut self.findings),
            }
        }
        if hash.finalize().as_bytes() != &index.spectra_blake3() {
            let message =
                "the spectra do not have the root page's hash; get the file again".to_owned();
            self.findings.add(rule::LIBRARY_INDEX_CHANGED, "/root", message);
        }
        Ok(())
    }

    /// Checks the entries of a leaf and their textures. Returns false if a limit forbids reading
    /// further textures.
    fn check_leaf(&mut self, leaf: usize, entries: &[Entry]) -> Result<bool, LibraryError> {
        for (i, entry) in entries.iter().enumerate() {
            let place = entry_place(leaf, i);
            self.entries += 1;
            // The size is counted before the texture is read, to limit the number of bytes that are
            // read in total.
            if let Err(fault) = self.ratio.count(entry, &place) {
                fault.add_to(&mut self.findings);
                return Ok(false);
            }
            self.check_name(entry, &place);
            self.check_gap(entry, &place);
            if !self.check_objects(entry, &place) {
                return Ok(false);
            }
            self.check_asset(entry, &place)?;
        }
        Ok(true)
    }

    /// Checks that no earlier name denotes the same file on some system.
    fn check_name(&mut self, entry: &Entry, place: &str) {
        let is_other = self.names.insert(&entry.name);
        self.findings
            .require(is_other, rule::LIBRARY_NAMES_ALIKE, place, || {
                format!(
                    "{} differs from another name only in case or in Unicode normalisation; rename one and pack the library again",
                    entry.name
                )
            });
    }

    /// Checks that a texture's own bytes directly follow the own bytes of the previous texture.
    fn check_gap(&mut self, entry: &Entry, place: &str) {
        let (expected, own) = (self.next, &entry.place.own);
        self.next = Some(own.end);
        if expected.is_some_and(|expected| expected != own.start) {
            let message = format!(
                "{} begins at byte {} of the payload and the texture before it ends at {}; pack the library again",
                entry.name,
                own.start,
                expected.unwrap_or(0)
            );
            self.findings.add(rule::LIBRARY_RANGE_INVALID, place, message);
        }
    }

    /// Checks that any two shared objects are equal or do not overlap. Returns false if there are
    /// too many objects.
    fn check_objects(&mut self, entry: &Entry, place: &str) -> bool {
        for cut in &entry.place.cuts {
            let (start, end) = (cut.object.start, cut.object.end);
            if self.objects.get(&start) == Some(&end) {
                continue;
            }
            // Known objects do not overlap, so only the last one that begins before `end` can
            // overlap this one.
            let before = self.objects.range(..end).next_back();
            if before.is_some_and(|(_, other)| *other > start) {
                let message = format!(
                    "a shared object of {} overlaps another one; pack the library again",
                    entry.name
                );
                self.findings.add(rule::LIBRARY_RANGE_INVALID, place, message);
                continue;
            }
            if self.objects.len() as u64 == self.limits.objects {
                let message = format!(
                    "there are more than {} shared objects; raise the limit if you trust the file",
                    self.limits.objects
                );
                self.findings.add(rule::LIBRARY_OBJECTS_TOO_MANY, place, message);
                return false;
            }
            self.objects.insert(start, end);
        }
        true
    }

    fn check_asset(&mut self, entry: &Entry, place: &str) -> Result<(), LibraryError> {
        let ranges = self.library.index().asset_ranges(entry).into_iter();
        let parts: Result<Vec<_>, _> = ranges.map(|r| self.library.read_range(r)).collect();
        // If a part is missing, the hash of an empty file is compared. No texture has this hash, so
        // a missing part is reported as a changed texture.
        let asset = assembled(entry, &parts?).unwrap_or_default();
        if blake3::hash(&asset).as_bytes() != &entry.blake3 {
            changed(entry, place).add_to(&mut self.findings);
            return Ok(());
        }
        match Asset::from_bytes(&asset) {
            Ok(asset) => self.check_facts(entry, &Facts::new(&asset.manifest), place),
            Err(error) => {
                let message = format!("{}: {error}", entry.name);
                self.findings.add(rule::LIBRARY_ASSET_INVALID, place, message);
            }
        }
        Ok(())
    }

    /// Compares the texture with what the index states about it.
    fn check_facts(&mut self, entry: &Entry, facts: &Facts, place: &str) {
        for (what, is_same) in [
            ("tags", entry.tags == facts.tags),
            ("models", entry.models == facts.models),
            ("conditions", entry.conditions == facts.conditions),
            ("contact", entry.contact == facts.contact),
            ("exponents of the law", entry.law == facts.law),
            // An index of version 1.0 does not state the facts below.
            ("licence", entry.quantity.is_none() || entry.license == facts.license),
            ("author", entry.quantity.is_none() || entry.author == facts.author),
            ("quantity", entry.quantity.is_none_or(|quantity| quantity == facts.quantity)),
        ] {
            self.findings.require(is_same, rule::LIBRARY_ENTRY_WRONG, place, || {
                format!(
                    "{}: the index states other {what} than the texture; pack the library again",
                    entry.name
                )
            });
        }
    }

    /// Checks the totals, which are known only after the last leaf.
    fn check_end(&mut self) {
        if !self.is_whole {
            return;
        }
        let header = self.library.index().header();
        let (counted, stated) = (self.entries, header.entries);
        self.findings
            .require(counted == stated, rule::LIBRARY_COUNT_WRONG, "/header", || {
                format!("the index has {counted} textures and the header states {stated}; pack the library again")
            });
        let (end, payload) = (self.next.unwrap_or(0), length(&header.payload));
        self.findings
            .require(end == payload, rule::LIBRARY_RANGE_INVALID, "/header", || {
                format!("the last texture ends at byte {end} of the payload, which has {payload}; pack the library again")
            });
        let used: u64 = self.objects.iter().map(|(start, end)| end - start).sum();
        let objects = self.library.index().spectra_start().saturating_sub(header.shared.start);
        // A newer minor version may store something else after the objects.
        let is_newer = header.minor > MINOR;
        let unused = if is_newer { 0 } else { objects.saturating_sub(used) };
        self.findings.require(unused == 0, rule::LIBRARY_OBJECT_UNUSED, "/header", || {
            format!("no texture uses {unused} bytes of the shared part; pack the library again")
        });
    }
}
