//! Summarizes a library from its index.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::library::entry::{Conditions, Interval};
use crate::library::error::LibraryError;
use crate::library::header::MAJOR;
use crate::library::metadata::LibraryMetadata;
use crate::library::reader::Library;
use crate::library::source::LibrarySource;

/// A summary of a library: its metadata, and how many textures of each kind it has.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LibrarySummary {
    /// Name of the library; it may be empty.
    pub name: String,
    #[serde(flatten)]
    pub metadata: LibraryMetadata,
    /// Version of the library's format, such as `1.1`.
    pub format: String,
    /// Hash of the index, hexadecimal. It names the library.
    pub blake3: String,
    /// Number of textures.
    pub textures: u64,
    /// Size of the library's file, bytes.
    pub bytes: u64,
    /// Total size that all textures have as separate files, bytes.
    pub texture_bytes: u64,
    /// Smallest and largest speed and force at which the textures were recorded.
    #[serde(flatten)]
    pub conditions: Conditions,
    /// Number of textures of each licence. The key `none` counts the textures that state no
    /// licence. The index of a library of version 1.0 has no licences and no quantities.
    pub licenses: BTreeMap<String, u64>,
    /// Number of textures of each quantity.
    pub quantities: BTreeMap<String, u64>,
    /// Number of textures that each model describes; the keys are the ids of the models.
    pub models: BTreeMap<String, u64>,
    /// Number of textures of each kind of contact.
    pub contacts: BTreeMap<String, u64>,
    /// Number of textures with each tag.
    pub tags: BTreeMap<String, u64>,
}

impl<S: LibrarySource> Library<S> {
    /// Summarizes the library. Reads only the index.
    ///
    /// ```no_run
    /// let library = htex_format::library::Library::open("cloth.htexlib".as_ref())?;
    /// println!("{:?}", library.summary()?.licenses);
    /// # Ok::<(), htex_format::library::LibraryError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if a page of the index cannot be read or breaks a rule.
    pub fn summary(&self) -> Result<LibrarySummary, LibraryError> {
        let index = self.index();
        let mut summary = LibrarySummary {
            name: self.name().to_owned(),
            metadata: self.metadata().clone(),
            format: format!("{MAJOR}.{}", index.minor_version()),
            blake3: blake3::Hash::from_bytes(index.blake3()).to_hex().to_string(),
            textures: self.len(),
            bytes: index.file_bytes(),
            texture_bytes: 0,
            conditions: Conditions::default(),
            licenses: BTreeMap::new(),
            quantities: BTreeMap::new(),
            models: BTreeMap::new(),
            contacts: BTreeMap::new(),
            tags: BTreeMap::new(),
        };
        let count = |counts: &mut BTreeMap<String, u64>, word: String| {
            *counts.entry(word).or_default() += 1;
        };
        for entry in self.entries() {
            let entry = entry?;
            summary.texture_bytes += entry.bytes;
            let Conditions { speed_mm_s, force_n } = &mut summary.conditions;
            *speed_mm_s = widest(*speed_mm_s, entry.conditions.speed_mm_s);
            *force_n = widest(*force_n, entry.conditions.force_n);
            if let Some(quantity) = entry.quantity {
                let license = entry.license.unwrap_or_else(|| "none".to_owned());
                count(&mut summary.licenses, license);
                count(&mut summary.quantities, quantity.name().to_owned());
            }
            count(&mut summary.contacts, entry.contact.name().to_owned());
            entry.models.into_iter().for_each(|model| count(&mut summary.models, model));
            entry.tags.into_iter().for_each(|tag| count(&mut summary.tags, tag));
        }
        Ok(summary)
    }
}

/// Returns the smallest interval that contains both intervals.
fn widest(a: Option<Interval>, b: Option<Interval>) -> Option<Interval> {
    match (a, b) {
        (Some(a), Some(b)) => Some(Interval { min: a.min.min(b.min), max: a.max.max(b.max) }),
        (a, b) => a.or(b),
    }
}
