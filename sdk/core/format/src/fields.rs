//! Matches an asset's stored fields to a model's fields, by name.
//!
//! The player, scenes, `htex info` and `htex validate` all use this module. An asset may store
//! fields in any order. The model receives the fields in the order of its descriptor.

use htex_model::{Descriptor, Kind};
use semver::Version;

use crate::block::split;
use crate::rules as rule;
use crate::{Manifest, Representation, StoredField, WriteError};
use htex_base::finding::Findings;
use htex_base::finding::Rule;

/// A difference between the stored fields and the model's fields.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FieldMismatch {
    /// The model has no field of this name.
    #[error("the model has no field {name:?}; its fields are {there}")]
    Unknown {
        /// Index of the field among the stored fields.
        index: usize,
        name: String,
        there: String,
    },
    /// The asset stores a list where the model has a scalar, or a scalar where the model has a
    /// list.
    #[error("{name:?} is stored as {stored} and the model expects {wanted}")]
    Kind {
        /// Index of the field among the stored fields.
        index: usize,
        name: String,
        /// The kind of field that the asset stores: a list or one number.
        stored: &'static str,
        /// The kind of field that the model expects: a list or one number.
        wanted: &'static str,
    },
    /// The stored unit differs from the model's unit.
    #[error("{name:?} is stored {} and the model expects it {}", words(.stored), words(.wanted))]
    Unit {
        /// Index of the field among the stored fields.
        index: usize,
        name: String,
        /// The stored unit; empty for a pure number.
        stored: String,
        /// The model's unit; empty for a pure number.
        wanted: String,
    },
    /// The asset does not store a field of the model, and the model has no default for this field.
    #[error("the model's field {name:?} is not stored")]
    Missing { name: String },
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
            Self::Unknown { .. } => "use the model's name, or remove the field",
            Self::Kind { .. } => "correct `list` and fit again",
            Self::Unit { .. } => "correct `unit`, and the numbers with it",
            Self::Missing { .. } => "fit again",
        }
    }

    /// Returns the JSON pointer to the mismatch, inside the representation.
    fn pointer(&self) -> String {
        match self {
            Self::Unknown { index, .. } => format!("/fields/{index}/name"),
            Self::Kind { index, .. } | Self::Unit { index, .. } => format!("/fields/{index}"),
            Self::Missing { .. } => "/fields".to_owned(),
        }
    }
}

/// The mapping from an asset's stored fields to the fields of a model, in the model's order.
/// [`match_fields`] returns this mapping.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldOrder<'a> {
    stored: &'a [StoredField],
    parts: Vec<Part>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    /// Index of the field among the stored fields.
    Stored(usize),
    /// The model's default value, for an asset that was written before the model had the field.
    Default(f64),
}

/// Matches stored fields to a model's fields by name, in any order.
///
/// # Errors
/// Returns an error if any field does not match. The error lists all mismatches. The mismatches of
/// stored fields come first, in the order of the fields.
pub fn match_fields<'a>(
    stored: &'a [StoredField],
    model: &Descriptor,
) -> Result<FieldOrder<'a>, Vec<FieldMismatch>> {
    let all = stored.iter().enumerate();
    let mut mismatches: Vec<FieldMismatch> =
        all.filter_map(|(index, field)| mismatch(index, field, model)).collect();
    let mut parts = Vec::with_capacity(model.fields.len());
    for field in &model.fields {
        let place = stored.iter().position(|s| s.name == field.name);
        match place.map(Part::Stored).or(field.default.map(Part::Default)) {
            Some(part) => parts.push(part),
            None => mismatches.push(FieldMismatch::Missing { name: field.name.clone() }),
        }
    }
    if mismatches.is_empty() {
        return Ok(FieldOrder { stored, parts });
    }
    Err(mismatches)
}

fn mismatch(index: usize, stored: &StoredField, model: &Descriptor) -> Option<FieldMismatch> {
    let name = || stored.name.clone();
    let Some(field) = model.fields.iter().find(|field| field.name == stored.name) else {
        let names: Vec<&str> = model.fields.iter().map(|f| f.name.as_str()).collect();
        let there = names.join(", ");
        let name = name();
        return Some(FieldMismatch::Unknown { index, name, there });
    };
    let list = matches!(field.kind, Kind::List { .. });
    if list != stored.list {
        let (name, [stored, wanted]) = (name(), [stored.list, list].map(kind));
        return Some(FieldMismatch::Kind { index, name, stored, wanted });
    }
    let wanted = stored_unit(&field.unit);
    (wanted != stored.unit).then(|| FieldMismatch::Unit {
        index,
        name: name(),
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

/// Converts a descriptor's unit to an asset's unit, which is empty for a pure number.
pub fn stored_unit(unit: &str) -> &str {
    if unit == "1" { "" } else { unit }
}

impl FieldOrder<'_> {
    /// Rearranges a flat array from the order of the stored fields to the model's order.
    ///
    /// # Errors
    /// Returns [`WriteError::Layout`] if the array does not match the stored fields.
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

/// A function that returns the descriptor of a representation's model, or `None` if the reader does
/// not have this model.
pub type KnownModel<'a> = &'a dyn Fn(&Representation) -> Option<&'a Descriptor>;

/// Adds a finding for each stored field that does not match its model's field. Representations of
/// unknown models are skipped.
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

/// Returns whether the version of the model that fitted an asset is newer than the known version. A
/// newer version may have more fields.
fn is_newer(fitted: &str, known: &str) -> bool {
    let [fitted, known] = [fitted, known].map(|version| Version::parse(version).ok());
    fitted > known
}
