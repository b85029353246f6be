//! The facts about an asset that the index states. These facts come from the asset's manifest.

use crate::{Contact, Law, Manifest, Quantity};

#[cfg(feature = "write")]
use crate::library::entry::Entry;
use crate::library::entry::{Conditions, Interval};
use crate::library::wire::TEXT_BYTES;

/// Largest number of tags of a texture in the index, and largest number of its models.
pub(crate) const MOST_WORDS: usize = 64;

/// What the index states about an asset.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Facts {
    pub tags: Vec<String>,
    pub models: Vec<String>,
    pub conditions: Conditions,
    pub contact: Contact,
    pub law: Law,
    pub license: Option<String>,
    pub author: Option<String>,
    pub quantity: Quantity,
}

impl Facts {
    /// Returns what the index states about an entry; `None` if the index is of version 1.0 and does
    /// not state everything.
    #[cfg(feature = "write")]
    pub(crate) fn of_entry(entry: &Entry) -> Option<Self> {
        Some(Self {
            quantity: entry.quantity?,
            tags: entry.tags.clone(),
            models: entry.models.clone(),
            conditions: entry.conditions,
            contact: entry.contact,
            law: entry.law,
            license: entry.license.clone(),
            author: entry.author.clone(),
        })
    }

    pub(crate) fn new(manifest: &Manifest) -> Self {
        let representations = manifest.representations.iter();
        let known = manifest.conditions.iter().filter(|c| c.is_recorded());
        // A manifest may contain -0. Adding zero turns it into 0.
        let speeds = known.clone().filter_map(|c| c.speed_mm_s).map(|x| x + 0.0);
        let forces = known.filter_map(|c| c.force_n).map(|x| x + 0.0);
        Self {
            tags: manifest.tags.clone(),
            models: representations.map(|r| r.model.clone()).collect(),
            conditions: Conditions {
                speed_mm_s: Interval::around(speeds),
                force_n: Interval::around(forces),
            },
            contact: manifest.contact,
            law: manifest.law().without_measurements(),
            license: manifest.license.as_deref().map(start),
            author: manifest.author.as_deref().map(start),
            quantity: manifest.quantity,
        }
    }
}

/// Returns the start of a text that the index can store.
fn start(text: &str) -> String {
    let end = (0..=text.len().min(TEXT_BYTES)).rev().find(|end| text.is_char_boundary(*end));
    text[..end.unwrap_or_default()].to_owned()
}
