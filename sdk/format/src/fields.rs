//! Stored fields, matched by name to a model's.

use htex_model::{Descriptor, Kind};
use semver::Version;

use crate::block::split;
use crate::report::Findings;
use crate::rules as rule;
use crate::{Field, Manifest, Representation, Rule, WriteError};

/// A stored field that the model does not have, or reads otherwise, or one of the model's that is
/// not stored.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FieldMismatch {
    /// The model has no field of this name.
    #[error("{name:?} is no field of the model, which has {there}")]
    Unknown {
        /// Place among the stored fields.
        index: usize,
        /// The stored name.
        name: String,
        /// The names of the model's fields.
        there: String,
    },
    /// A list is stored where the model takes one number, or the other way round.
    #[error("{name:?} is stored as {stored} and the model takes {wanted}")]
    Kind {
        /// Place among the stored fields.
        index: usize,
        /// Its name.
        name: String,
        /// What is stored.
        stored: &'static str,
        /// What the model takes.
        wanted: &'static str,
    },
    /// The unit is another one.
    #[error("{name:?} is stored {} and the model takes it {}", words(.stored), words(.wanted))]
    Unit {
        /// Place among the stored fields.
        index: usize,
        /// Its name.
        name: String,
        /// The stored unit; empty for a pure number.
        stored: String,
        /// The model's unit; empty for a pure number.
        wanted: String,
    },
    /// A field of the model, without a default, is not stored.
    #[error("the model's field {name:?} is not stored")]
    Missing {
        /// Its name.
        name: String,
    },
}

impl FieldMismatch {
    fn rule(&self) -> &'static Rule {
        match self {
            Self::Unknown { .. } => rule::FIELD_UNKNOWN,
            Self::Kind { .. } => rule::FIELD_KIND_WRONG,
            Self::Unit { .. } => rule::FIELD_UNIT_WRONG,
            Self::Missing { .. } => rule::FIELD_MISSING,
        }
    }

    fn is_unknown(&self) -> bool {
        matches!(self, Self::Unknown { .. })
    }

    fn remedy(&self) -> &'static str {
        match self {
            Self::Unknown { .. } => "use the model's name, or take the field out",
            Self::Kind { .. } => "correct `list` and fit again",
            Self::Unit { .. } => "correct `unit`, and the numbers with it",
            Self::Missing { .. } => "fit again",
        }
    }

    /// JSON pointer inside the representation.
    fn pointer(&self) -> String {
        match self {
            Self::Unknown { index, .. } => format!("/fields/{index}/name"),
            Self::Kind { index, .. } | Self::Unit { index, .. } => format!("/fields/{index}"),
            Self::Missing { .. } => "/fields".to_owned(),
        }
    }
}

/// Where the fields of a model come from in the parameters of an asset.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldOrder<'a> {
    stored: &'a [Field],
    parts: Vec<Part>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    /// A place among the stored fields.
    Stored(usize),
    /// The model's default: the asset is older than the field.
    Default(f64),
}

/// Matches stored fields to a model's by their names; the order may be another one.
///
/// # Errors
/// Every mismatch, those of stored fields first, in their order.
pub fn match_fields<'a>(
    stored: &'a [Field],
    model: &Descriptor,
) -> Result<FieldOrder<'a>, Vec<FieldMismatch>> {
    let all = stored.iter().enumerate();
    let mut mismatches: Vec<FieldMismatch> = all
        .filter_map(|(index, field)| mismatch(index, field, model))
        .collect();
    let mut parts = Vec::with_capacity(model.fields.len());
    for field in &model.fields {
        let place = stored.iter().position(|s| s.name == field.name);
        match place.map(Part::Stored).or(field.default.map(Part::Default)) {
            Some(part) => parts.push(part),
            None => mismatches.push(FieldMismatch::Missing {
                name: field.name.clone(),
            }),
        }
    }
    if mismatches.is_empty() {
        return Ok(FieldOrder { stored, parts });
    }
    Err(mismatches)
}

fn mismatch(index: usize, stored: &Field, model: &Descriptor) -> Option<FieldMismatch> {
    let name = stored.name.clone();
    let Some(field) = model.fields.iter().find(|field| field.name == name) else {
        let names: Vec<&str> = model.fields.iter().map(|f| f.name.as_str()).collect();
        let there = names.join(", ");
        return Some(FieldMismatch::Unknown { index, name, there });
    };
    let list = matches!(field.kind, Kind::List { .. });
    if list != stored.list {
        let [stored, wanted] = [stored.list, list].map(kind);
        return Some(FieldMismatch::Kind {
            index,
            name,
            stored,
            wanted,
        });
    }
    let wanted = stored_unit(&field.unit);
    (wanted != stored.unit).then(|| FieldMismatch::Unit {
        index,
        name,
        stored: stored.unit.clone(),
        wanted: wanted.to_owned(),
    })
}

fn words(unit: &str) -> String {
    match unit {
        "" => "as a pure number".to_owned(),
        unit => format!("in {unit:?}"),
    }
}

fn kind(list: bool) -> &'static str {
    if list { "a list" } else { "one number" }
}

/// A descriptor's unit as an asset stores it: empty for a pure number.
pub fn stored_unit(unit: &str) -> &str {
    if unit == "1" { "" } else { unit }
}

impl FieldOrder<'_> {
    /// A flat array of the stored fields as the model takes it.
    ///
    /// # Errors
    /// [`WriteError::Layout`] when the array does not follow the stored fields.
    pub fn arrange(&self, flat: &[f64]) -> Result<Vec<f64>, WriteError> {
        let stored = split(self.stored, flat)?;
        let mut arranged = Vec::with_capacity(flat.len());
        for part in &self.parts {
            match *part {
                Part::Default(value) => arranged.push(value),
                Part::Stored(place) => {
                    let (field, values) = stored[place];
                    if field.list {
                        arranged.push(values.len() as f64);
                    }
                    arranged.extend_from_slice(values);
                }
            }
        }
        Ok(arranged)
    }
}

/// The description of a model that can play a representation, where the reader has one.
pub type KnownModel<'a> = &'a dyn Fn(&Representation) -> Option<&'a Descriptor>;

/// Adds a finding for each field that does not agree with its model's, where that is known.
pub(crate) fn check_fields(manifest: &Manifest, known: KnownModel<'_>, findings: &mut Findings) {
    for (i, representation) in manifest.representations.iter().enumerate() {
        let Some(model) = known(representation) else {
            continue;
        };
        let mismatches = match_fields(&representation.fields, model).err();
        for mismatch in mismatches.into_iter().flatten() {
            if !(mismatch.is_unknown() && is_newer(&representation.model_version, &model.version)) {
                let pointer = format!("/representations/{i}{}", mismatch.pointer());
                let message = format!("{mismatch}; {}", mismatch.remedy());
                findings.add(mismatch.rule(), pointer, message);
            }
        }
    }
}

/// Whether an asset's version of a model is newer than the known one, and may have more fields.
fn is_newer(fitted: &str, known: &str) -> bool {
    let [fitted, known] = [fitted, known].map(|version| Version::parse(version).ok());
    fitted > known
}
