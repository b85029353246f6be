//! Selects textures of a library by a property, such as `license=CC*`.

use std::str::FromStr;

use htex_format::library::{Entry, NamePattern};
use htex_format::{Contact, Manifest};

use crate::BuildError;

/// A property that textures must have: a field, and a pattern that the value of the field must
/// match.
///
/// ```
/// let filter: htex_build::Filter = "license=CC*".parse()?;
/// assert!("licence=CC*".parse::<htex_build::Filter>().is_err());
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone)]
pub struct Filter {
    field: Field,
    pattern: NamePattern,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Field {
    Name,
    Tag,
    Model,
    Contact,
    License,
    Author,
    Quantity,
}

/// Names of the fields.
const FIELDS: [(&str, Field); 7] = [
    ("name", Field::Name),
    ("tag", Field::Tag),
    ("model", Field::Model),
    ("contact", Field::Contact),
    ("license", Field::License),
    ("author", Field::Author),
    ("quantity", Field::Quantity),
];

impl FromStr for Filter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = || FIELDS.map(|(name, _)| name).join(", ");
        let (name, pattern) = text
            .split_once('=')
            .ok_or_else(|| format!("{text}: give FIELD=VALUE; the fields are {}", names()))?;
        let field = FIELDS.iter().find(|(known, _)| *known == name).map(|(_, field)| *field);
        let field = field.ok_or_else(|| {
            format!("there is no field {name} to select textures by; there are {}", names())
        })?;
        Ok(Self { field, pattern: pattern.parse()? })
    }
}

impl Filter {
    /// Returns whether a texture of a library matches all filters. `manifest` reads its manifest,
    /// which is needed only for fields that the index does not have.
    pub(crate) fn all<'m>(
        filters: &[Self],
        entry: &Entry,
        manifest: &dyn Fn() -> Result<&'m Manifest, BuildError>,
    ) -> Result<bool, BuildError> {
        for filter in filters {
            let matches = match (filter.field, entry.quantity) {
                (Field::License, Some(_)) => filter.matches_stated(entry.license.as_deref()),
                (Field::Author, Some(_)) => filter.matches_stated(entry.author.as_deref()),
                (Field::Quantity, Some(quantity)) => filter.pattern.matches_text(quantity.name()),
                // The index of a library of version 1.0 does not contain these fields.
                (Field::License | Field::Author | Field::Quantity, None) => {
                    filter.matches_manifest(&entry.name, manifest()?)
                }
                _ => filter.matches(&entry.name, &entry.tags, &entry.models, entry.contact),
            };
            if !matches {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Returns whether a texture with this name and this manifest matches.
    pub fn matches_manifest(&self, name: &str, manifest: &Manifest) -> bool {
        match self.field {
            Field::License => self.matches_stated(manifest.license.as_deref()),
            Field::Author => self.matches_stated(manifest.author.as_deref()),
            Field::Quantity => self.pattern.matches_text(manifest.quantity.name()),
            _ => {
                let models = manifest.representations.iter().map(|r| r.model.clone());
                let models: Vec<String> = models.collect();
                self.matches(name, &manifest.tags, &models, manifest.contact)
            }
        }
    }

    fn matches_stated(&self, text: Option<&str>) -> bool {
        self.pattern.matches_text(text.unwrap_or(""))
    }

    fn matches(&self, name: &str, tags: &[String], models: &[String], contact: Contact) -> bool {
        let is = |text: &str| self.pattern.matches_text(text);
        match self.field {
            Field::Name => self.pattern.matches(name),
            Field::Tag => tags.iter().any(|tag| is(tag)),
            Field::Model => models.iter().any(|id| is(id) || id.rsplit('.').next().is_some_and(is)),
            Field::Contact => is(contact.name()),
            // Only manifests have the others.
            _ => false,
        }
    }
}
