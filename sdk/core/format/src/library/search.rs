//! Searches a library by spectra.

use std::collections::HashMap;

use crate::Quantity;
use crate::library::coarse_spectrum::CoarseSpectrum;
use crate::library::entry::Entry;
use crate::library::error::LibraryError;
use crate::library::query::Query;
use crate::library::reader::Library;
use crate::library::source::LibrarySource;

/// A texture, and how far its spectrum is from another one.
#[derive(Debug, Clone, PartialEq)]
pub struct Similar {
    pub entry: Entry,
    /// RMS difference of the levels of both spectra, decibels
    /// ([`CoarseSpectrum::distance_db`]).
    pub distance_db: f64,
}

/// A texture whose spectrum nearly equals that of another texture.
#[derive(Debug, Clone, PartialEq)]
pub struct Duplicate {
    pub entry: Entry,
    /// Name of the nearest texture of those before it in the library.
    pub of: String,
    /// RMS difference of the levels of both spectra, decibels.
    pub distance_db: f64,
}

impl<S: LibrarySource> Library<S> {
    /// Returns the textures of a quantity whose spectra are nearest to a spectrum, the nearest one
    /// first, at most `most`. Only textures that match the query are returned. Textures without a
    /// spectrum are not.
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
    /// If the index or the spectra cannot be read or break a rule.
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
            // Equal distances keep the order of the names.
            let place = nearest.partition_point(|near| near.distance_db <= distance_db);
            if place < most {
                nearest.insert(place, Similar { entry, distance_db });
                nearest.truncate(most);
            }
        }
        Ok(nearest)
    }

    /// Returns the textures whose spectra are at most `within_db` from that of another texture of
    /// the same quantity, sorted by name. Of a group of equal textures, the first one is left out.
    /// Only textures that match the query are compared.
    ///
    /// # Errors
    /// If the index or the spectra cannot be read or break a rule.
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
            all.push(Candidate { entry, quantity, spectrum, mean_db: spectrum.mean_db() });
        }
        found.extend(near(&all, within_db));
        found.sort_by(|a, b| a.entry.name.cmp(&b.entry.name));
        Ok(found)
    }
}

/// What equal spectra have in common.
type Key = (u8, u32, [u8; 48]);

/// A texture that may be near others.
struct Candidate {
    entry: Entry,
    quantity: Quantity,
    spectrum: CoarseSpectrum,
    mean_db: f64,
}

/// Returns the candidates that are near one before them. The candidates are sorted by name.
fn near(all: &[Candidate], within_db: f64) -> Vec<Duplicate> {
    // The means of two spectra differ by at most their distance, so that only neighbours in the
    // order of means need a comparison.
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
            let distance_db = a.spectrum.distance_db(&b.spectrum);
            let (first, later) = (*one.min(other), *one.max(other));
            let is_nearer =
                nearest[later].is_none_or(|(known, db)| (distance_db, first) < (db, known));
            if distance_db <= within_db && is_nearer {
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
