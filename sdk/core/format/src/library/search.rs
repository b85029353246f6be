//! Searches a library by spectra.

use std::collections::HashMap;

use crate::Quantity;
use crate::library::coarse_spectrum::{CoarseSpectrum, POINTS};
use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::query::Query;
use crate::library::reader::Library;
use crate::library::source::LibrarySource;

/// A texture, and how much its spectrum differs from a given spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct Similar {
    pub entry: Entry,
    /// RMS difference of the levels of both spectra, decibels
    /// ([`CoarseSpectrum::distance_db`]).
    pub distance_db: f64,
}

/// A texture whose spectrum nearly equals another texture's spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct Duplicate {
    pub entry: Entry,
    /// Name of the most similar texture. Only textures that come before `entry` in the library,
    /// have the same quantity, and match the query are considered.
    pub of: String,
    /// RMS difference of the levels of both spectra, decibels.
    pub distance_db: f64,
}

impl<S: LibrarySource> Library<S> {
    /// Finds the textures whose spectra are most similar to a given spectrum: at most `most`
    /// textures, the most similar first. The function considers only textures that have the given
    /// quantity, have a spectrum, and match the query.
    ///
    /// ```no_run
    /// # use htex_format::library::{Library, Query};
    /// let library = Library::open("cloth.htexlib".as_ref())?;
    /// let cotton = library.needed("woven/cotton")?;
    /// let spectrum = library.description(&cotton)?.spectrum;
    /// if let (Some(spectrum), Some(quantity)) = (spectrum, cotton.quantity) {
    ///     for similar in library.similar(&spectrum, quantity, &Query::default(), 10)? {
    ///         println!("{}: {:.1} dB", similar.entry.name, similar.distance_db);
    ///     }
    /// }
    /// # Ok::<(), htex_format::library::LibraryError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the index or the spectra cannot be read or break a rule.
    pub fn similar(
        &self,
        spectrum: &CoarseSpectrum,
        quantity: Quantity,
        query: &Query,
        most: usize,
    ) -> Result<Vec<Similar>, LibraryError> {
        let mut nearest: Vec<Similar> = Vec::new();
        for described in self.described() {
            let (entry, description) = described?;
            let Some(other) = description.spectrum else { continue };
            if entry.quantity != Some(quantity) || !query.matches(&entry) {
                continue;
            }
            let distance_db = spectrum.distance_db(&other);
            // Textures with equal distances stay in the order of their names.
            let place = nearest.partition_point(|near| near.distance_db <= distance_db);
            if place < most {
                nearest.insert(place, Similar { entry, distance_db });
                nearest.truncate(most);
            }
        }
        Ok(nearest)
    }

    /// Returns each texture whose spectrum nearly equals the spectrum of an earlier texture, sorted
    /// by name. The spectra of the two textures differ by at most `within_db`, and both textures
    /// have the same quantity. In a group of textures with nearly equal spectra, the result does
    /// not contain the first texture. Only textures that match the query are compared.
    ///
    /// # Errors
    /// Returns an error if the index or the spectra cannot be read or break a rule.
    pub fn duplicates(
        &self,
        query: &Query,
        within_db: f64,
    ) -> Result<Vec<Duplicate>, LibraryError> {
        let (mut all, mut found) = (Vec::new(), Vec::new());
        let mut firsts: HashMap<Key, usize> = HashMap::new();
        for described in self.described() {
            let (entry, description) = described?;
            let (Some(spectrum), Some(quantity)) = (description.spectrum, entry.quantity) else {
                continue;
            };
            if !query.matches(&entry) {
                continue;
            }
            // Equal spectra are found at once, because a library may have very many of them.
            let key = (quantity as u8, spectrum.largest_db.to_bits(), spectrum.levels);
            let first = *firsts.entry(key).or_insert(all.len());
            if first < all.len() {
                let Candidate { entry: other, .. } = &all[first];
                found.push(Duplicate { of: other.name.clone(), entry, distance_db: 0.0 });
                continue;
            }
            all.push(Candidate::new(entry, quantity, spectrum));
        }
        found.extend(near(&all, within_db));
        found.sort_by(|a, b| a.entry.name.cmp(&b.entry.name));
        Ok(found)
    }
}

/// The quantity, the largest level and the levels: textures with equal spectra have the same key.
type Key = (u8, u32, [u8; 48]);

/// A texture that may be near others.
struct Candidate {
    entry: Entry,
    quantity: Quantity,
    spectrum: CoarseSpectrum,
    /// The mean level, and the difference between the lower and the upper half of the levels,
    /// decibels. Between two spectra, each of these values differs by at most the distance of the
    /// spectra.
    mean_db: f64,
    tilt_db: f64,
}

impl Candidate {
    fn new(entry: Entry, quantity: Quantity, spectrum: CoarseSpectrum) -> Self {
        let levels = spectrum.levels_db();
        let sum = |levels: &[f64]| levels.iter().sum::<f64>() / POINTS as f64;
        let (low, high) = levels.split_at(POINTS / 2);
        let (low, high) = (sum(low), sum(high));
        Self { entry, quantity, spectrum, mean_db: low + high, tilt_db: low - high }
    }

    /// Returns the distance to another spectrum, if it is at most `within_db`.
    fn distance_within(&self, other: &Self, within_db: f64) -> Option<f64> {
        if (self.tilt_db - other.tilt_db).abs() > within_db {
            return None;
        }
        Some(self.spectrum.distance_db(&other.spectrum)).filter(|distance| *distance <= within_db)
    }
}

/// Returns each candidate that is near an earlier candidate. The candidates are sorted by name.
fn near(all: &[Candidate], within_db: f64) -> Vec<Duplicate> {
    // The means of two spectra differ by at most the distance of the spectra. Therefore, only
    // spectra with similar means need to be compared.
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|a, b| {
        let key = |i: usize| (all[i].quantity, all[i].mean_db);
        key(*a).0.cmp(&key(*b).0).then(key(*a).1.total_cmp(&key(*b).1))
    });
    let mut nearest: Vec<Option<(usize, f64)>> = vec![None; all.len()];
    for (place, one) in order.iter().enumerate() {
        for other in &order[place + 1..] {
            let (a, b) = (&all[*one], &all[*other]);
            if a.quantity != b.quantity || b.mean_db - a.mean_db > within_db {
                break;
            }
            let Some(distance_db) = a.distance_within(b, within_db) else { continue };
            let (first, later) = (*one.min(other), *one.max(other));
            let is_nearer =
                nearest[later].is_none_or(|(known, db)| (distance_db, first) < (db, known));
            if is_nearer {
                nearest[later] = Some((first, distance_db));
            }
        }
    }
    let found = nearest.into_iter().enumerate().filter_map(|(later, near)| {
        let (first, distance_db) = near?;
        let of = all[first].entry.name.clone();
        Some(Duplicate { entry: all[later].entry.clone(), of, distance_db })
    });
    found.collect()
}
