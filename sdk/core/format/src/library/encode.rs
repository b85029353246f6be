//! Encodes the index: turns sorted entries into leaf pages and a root page.

use std::collections::BTreeSet;

use crate::library::coarse_spectrum::CoarseSpectrum;
use crate::library::entry::{Conditions, Entry, Interval};
use crate::library::leaf::{
    CONTACTS, FORCE, LARGEST_ERROR, ONE_FORCE, ONE_SPEED, QUANTITIES, SOURCES, SPEED, length,
};
use crate::library::metadata::LibraryMetadata;
use crate::library::page;
use crate::library::wire::{common_prefix, put_following, put_text, put_varint, varint_bytes};

/// Largest unpacked size of a leaf, bytes. An entry that would exceed it begins the next leaf. With
/// this size, the first read and a packed leaf together stay below 64 kB, and the root page of a
/// million textures fits into the first read.
const LEAF_BYTES: usize = 40 << 10;

/// The pages of an index.
#[derive(Debug, Default)]
pub(crate) struct Pages {
    leaves: Vec<u8>,
    lengths: Vec<u64>,
    /// Separators between the leaves, as the root page stores them.
    separators: Vec<Vec<u8>>,
    /// Entries of the leaf that is being filled.
    entries: Vec<Entry>,
    /// Spectra of these entries.
    spectra: Vec<Option<CoarseSpectrum>>,
    /// Packed pages of spectra, and their lengths.
    spectrum_pages: Vec<u8>,
    spectrum_lengths: Vec<u64>,
    words: BTreeSet<String>,
    size: usize,
    last: Vec<u8>,
}

impl Pages {
    /// Adds an entry. Its name must sort after all names that were added earlier.
    pub(crate) fn add(&mut self, entry: Entry, spectrum: Option<CoarseSpectrum>) {
        let size = self.size_of(&entry);
        // A leaf has at least one entry, even if this entry is larger than the limit. An entry with
        // the largest number of words and cuts still stays below the 64 KiB that readers allow.
        if !self.entries.is_empty() && self.size + size > LEAF_BYTES {
            self.end_leaf();
        }
        if self.entries.is_empty() {
            let shared = common_prefix(&self.last, entry.name.as_bytes());
            // The separator is the shortest prefix of this name that sorts after the last name of
            // the previous leaf. A short separator keeps the root page small.
            let is_first = self.separators.is_empty();
            // This name sorts after the last name, so it has at least one byte after the prefix
            // that both share. The separator may end inside a character, so separators are bytes.
            // The first separator is empty, so that every name has a leaf.
            let separator = if is_first { 0 } else { shared + 1 };
            self.separators.push(entry.name.as_bytes()[..separator].to_vec());
        }
        // The size is computed again, because a new leaf cannot share words or the start of a name
        // with an earlier leaf.
        self.size += self.size_of(&entry);
        let words = words(&entry);
        for word in words.filter(|word| !self.words.contains(*word)).cloned().collect::<Vec<_>>() {
            self.words.insert(word);
        }
        self.last = entry.name.clone().into_bytes();
        self.entries.push(entry);
        self.spectra.push(spectrum);
    }

    /// Returns an upper bound of the bytes that an entry adds to the leaf. Indices of words are
    /// below 2^14, so they take two bytes.
    fn size_of(&self, entry: &Entry) -> usize {
        let before: &[u8] = if self.entries.is_empty() { &[] } else { &self.last };
        let name = entry.name.as_bytes();
        // A name has two lengths of up to 255, and each takes up to two bytes.
        let name = name.len() - common_prefix(before, name) + 4;
        let words = words(entry);
        let new = words.clone().filter(|word| !self.words.contains(*word));
        let words = new.map(|word| word.len() + 2).sum::<usize>() + 2 * words.count() + 2;
        let cuts = entry
            .place
            .cuts
            .iter()
            .map(|cut| varint_bytes(cut.object.end) * 2 + varint_bytes(cut.at));
        // After the name and words: conditions (33), own length, number of cuts (2), cuts, hash
        // (32), contact and law (25), quantity and two errors (7).
        name + words
            + 33
            + varint_bytes(length(&entry.place.own))
            + 2
            + cuts.sum::<usize>()
            + 32
            + 25
            + 7
    }

    /// Finishes the index.
    pub(crate) fn finish(mut self, name: &str, metadata: &LibraryMetadata) -> PackedIndex {
        if !self.entries.is_empty() {
            self.end_leaf();
        }
        let mut root = Vec::new();
        put_text(&mut root, name);
        put_varint(&mut root, self.lengths.len() as u64);
        let mut before: &[u8] = &[];
        for separator in &self.separators {
            put_following(&mut root, before, separator);
            before = separator;
        }
        for length in &self.lengths {
            put_varint(&mut root, *length);
        }
        // Metadata consist of texts, so the conversion to JSON cannot fail.
        let json = serde_json::to_vec(metadata).unwrap_or_else(|_| b"{}".to_vec());
        put_varint(&mut root, json.len() as u64);
        root.extend(json);
        for length in &self.spectrum_lengths {
            put_varint(&mut root, *length);
        }
        root.extend(blake3::hash(&self.spectrum_pages).as_bytes());
        PackedIndex {
            root: page::pack(&root),
            leaf_count: self.lengths.len() as u32,
            leaves: self.leaves,
            spectra: self.spectrum_pages,
        }
    }

    fn end_leaf(&mut self) {
        let page = page::pack(&leaf(&self.entries));
        self.lengths.push(page.len() as u64);
        self.leaves.extend(page);
        let page = spectra(&self.spectra);
        self.spectrum_lengths.push(page.len() as u64);
        self.spectrum_pages.extend(page);
        self.spectra.clear();
        self.entries.clear();
        self.words.clear();
        self.size = 0;
    }
}

/// The pages of a finished index.
pub(crate) struct PackedIndex {
    pub root: Vec<u8>,
    pub leaves: Vec<u8>,
    pub leaf_count: u32,
    pub spectra: Vec<u8>,
}

/// Returns all words of an entry: first the words that a leaf lists first, then the words that it
/// lists second.
fn words(entry: &Entry) -> impl Iterator<Item = &String> + Clone {
    let rights = entry.license.iter().chain(&entry.author);
    entry.tags.iter().chain(&entry.models).chain(rights)
}

/// Encodes the spectra of a leaf. Returns no bytes if there are none.
fn spectra(spectra: &[Option<CoarseSpectrum>]) -> Vec<u8> {
    if spectra.iter().all(Option::is_none) {
        return Vec::new();
    }
    let mut page = Vec::new();
    put_varint(&mut page, spectra.len() as u64);
    page.extend(spectra.iter().map(|spectrum| u8::from(spectrum.is_some())));
    for spectrum in spectra.iter().flatten() {
        page.extend(spectrum.largest_db.to_le_bytes());
        page.extend(spectrum.levels);
    }
    page::pack(&page)
}

/// Returns distinct texts in ascending order.
fn sorted<'a>(texts: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    let distinct: BTreeSet<&str> = texts.map(String::as_str).collect();
    distinct.into_iter().collect()
}

/// Encodes the entries of a leaf. There must be at least one.
fn leaf(entries: &[Entry]) -> Vec<u8> {
    let words = sorted(entries.iter().flat_map(|e| e.tags.iter().chain(&e.models)));
    let mut page = Vec::with_capacity(LEAF_BYTES);
    put_varint(&mut page, entries.len() as u64);
    put_varint(&mut page, words.len() as u64);
    words.iter().for_each(|word| put_text(&mut page, word));
    let mut before: &[u8] = &[];
    for entry in entries {
        put_following(&mut page, before, entry.name.as_bytes());
        before = entry.name.as_bytes();
    }
    entries.iter().for_each(|e| put_words(&mut page, &words, &e.tags));
    entries.iter().for_each(|e| put_words(&mut page, &words, &e.models));
    entries.iter().for_each(|e| put_conditions(&mut page, &e.conditions));
    entries.iter().for_each(|e| put_law(&mut page, e));
    // The textures' own bytes follow each other without gaps. Therefore, the start of the first
    // texture and the lengths suffice.
    put_varint(&mut page, entries.first().map_or(0, |e| e.place.own.start));
    entries.iter().for_each(|e| put_varint(&mut page, length(&e.place.own)));
    entries.iter().for_each(|e| put_cuts(&mut page, e));
    entries.iter().for_each(|e| page.extend(e.blake3));
    let rights = sorted(entries.iter().flat_map(|e| e.license.iter().chain(&e.author)));
    put_varint(&mut page, rights.len() as u64);
    rights.iter().for_each(|text| put_text(&mut page, text));
    entries.iter().for_each(|e| put_choice(&mut page, &rights, e.license.as_deref()));
    entries.iter().for_each(|e| put_choice(&mut page, &rights, e.author.as_deref()));
    let number = |e: &Entry| QUANTITIES.iter().position(|q| Some(*q) == e.quantity);
    page.extend(entries.iter().map(|e| number(e).unwrap_or_default() as u8));
    entries.iter().for_each(|e| put_error(&mut page, e.felt_error_rms_db));
    entries.iter().for_each(|e| put_error(&mut page, e.held_out_error_db));
    page
}

/// Appends the error in hundredths of a decibel plus 1, or 0 if there is no error.
fn put_error(page: &mut Vec<u8>, error_db: Option<f64>) {
    // The error is rounded up, so that a search with a largest error finds no texture that exceeds
    // it. The small number is subtracted because binary numbers do not represent all hundredths
    // exactly.
    let hundredths =
        error_db.map(|db| libm::ceil(db * 100.0 - 1e-6).clamp(0.0, LARGEST_ERROR as f64));
    put_varint(page, hundredths.map_or(0, |hundredths| hundredths as u64 + 1));
}

/// Appends the index of a text in `texts` plus 1, or 0 if there is no text.
fn put_choice(page: &mut Vec<u8>, texts: &[&str], chosen: Option<&str>) {
    let index = chosen.and_then(|chosen| texts.binary_search(&chosen).ok());
    put_varint(page, index.map_or(0, |index| index as u64 + 1));
}

fn put_words(page: &mut Vec<u8>, words: &[&str], chosen: &[String]) {
    put_varint(page, chosen.len() as u64);
    for word in chosen {
        // `words` contains all words of the leaf, so the search always succeeds.
        let index = words.binary_search(&word.as_str()).unwrap_or_else(|at| at);
        put_varint(page, index as u64);
    }
}

fn put_conditions(page: &mut Vec<u8>, conditions: &Conditions) {
    let bits = |interval: Option<Interval>, known, one| match interval {
        None => 0,
        Some(Interval { min, max }) if min == max => known | one,
        Some(_) => known,
    };
    page.push(
        bits(conditions.speed_mm_s, SPEED, ONE_SPEED) | bits(conditions.force_n, FORCE, ONE_FORCE),
    );
    for interval in [conditions.speed_mm_s, conditions.force_n].into_iter().flatten() {
        page.extend(interval.min.to_le_bytes());
        if interval.min != interval.max {
            page.extend(interval.max.to_le_bytes());
        }
    }
}

fn put_law(page: &mut Vec<u8>, entry: &Entry) {
    fn number<T: PartialEq>(all: &[T], one: &T) -> u8 {
        all.iter().position(|x| x == one).unwrap_or_default() as u8
    }
    let exponents = entry.law.exponents().map(|(_, exponent)| exponent);
    let sources = exponents.iter().enumerate();
    let bits = sources.map(|(i, one)| number(&SOURCES, &one.source) << (2 * i + 2));
    page.push(number(&CONTACTS, &entry.contact) | bits.fold(0, |all, bits| all | bits));
    for one in exponents {
        page.extend(one.exponent.to_le_bytes());
    }
}

fn put_cuts(page: &mut Vec<u8>, entry: &Entry) {
    put_varint(page, entry.place.cuts.len() as u64);
    let mut at = 0;
    for cut in &entry.place.cuts {
        put_varint(page, cut.at - at);
        put_varint(page, cut.object.start);
        put_varint(page, length(&cut.object));
        at = cut.at;
    }
}
