//! The facts about an asset that the index states. These facts come from the asset's manifest.

use crate::{Contact, Law, Manifest};

use crate::library::entry::{Conditions, Interval};

/// Largest number of tags of a texture in the index, and largest number of its models.
pub(crate) const MOST_WORDS: usize = 64;

/// Tags, models, conditions and law of an asset.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Facts {
    pub tags: Vec<String>,
    pub models: Vec<String>,
    pub conditions: Conditions,
    pub contact: Contact,
    pub law: Law,
}

impl Facts {
    pub(crate) fn new(manifest: &Manifest) -> Self {
        let representations = manifest.representations.iter();
        let known = manifest.conditions.iter();
        // Adding zero turns -0, which a manifest may have, into 0.
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
        }
    }
}
