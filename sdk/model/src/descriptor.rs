//! A model's descriptor, as a host reads it.

use alloc::string::String;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::{Kind, StaticDescriptor, StaticField, StaticOption, Store};

/// A model's description; crosses the ABI as JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Descriptor {
    /// Reverse-DNS identifier, e.g. `org.htex.sbeta`; never changes.
    #[cfg_attr(
        feature = "schemars",
        schemars(regex(pattern = r"^[a-z0-9_-]+(\.[a-z0-9_-]+){2,}$"))
    )]
    pub id: String,
    /// Name for people, e.g. `sBeta`.
    pub name: String,
    /// Semantic version of the model's parameters and sound.
    pub version: String,
    /// One sentence: what the model keeps of a spectrum.
    pub summary: String,
    /// Parameters, in the order of the flat array.
    #[cfg_attr(feature = "schemars", schemars(length(min = 1, max = 32)))]
    pub fields: Vec<Field>,
    /// Fit options, in the order of their array.
    #[serde(default)]
    pub options: Vec<FitOption>,
    /// The level of a fit is part of what the model keeps of a spectrum, as with energies, and stays as
    /// it is. Otherwise the level may be taken from the recording.
    #[serde(default, skip_serializing_if = "is_false")]
    pub keeps_level: bool,
}

fn is_false(flag: &bool) -> bool {
    !flag
}

/// One parameter field.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Field {
    /// Name, units included, e.g. `peak_hz`.
    pub name: String,
    /// Unit symbol; `1` for a pure number.
    pub unit: String,
    /// One number or several.
    pub kind: Kind,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
    /// How an asset stores the values.
    pub store: Store,
    /// Value for assets of earlier minor versions, which lack the field; a scalar's alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<f64>,
    /// What the field means.
    pub description: String,
}

/// One knob of the fit: a number, or one of several named choices (the number is its index).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct FitOption {
    /// Name as given on the command line.
    pub name: String,
    /// Unit symbol; `1` for a pure number.
    pub unit: String,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
    /// Default value.
    pub default: f64,
    /// Only whole numbers are allowed.
    #[serde(default)]
    pub integer: bool,
    /// Names of the values 0, 1, …; empty for a plain number.
    #[serde(default)]
    pub choices: Vec<String>,
    /// What the knob does, and where its default comes from.
    pub description: String,
}

impl Descriptor {
    /// The default of each option.
    pub fn default_options(&self) -> Vec<f64> {
        self.options.iter().map(|o| o.default).collect()
    }
}

impl From<&StaticDescriptor> for Descriptor {
    fn from(it: &StaticDescriptor) -> Self {
        Self {
            id: it.id.into(),
            name: it.name.into(),
            version: it.version.into(),
            summary: it.summary.into(),
            fields: it.fields.iter().map(Field::from).collect(),
            options: it.options.iter().map(FitOption::from).collect(),
            keeps_level: it.keeps_level,
        }
    }
}

impl From<&StaticField> for Field {
    fn from(it: &StaticField) -> Self {
        Self {
            name: it.name.into(),
            unit: it.unit.into(),
            kind: it.kind,
            min: it.min,
            max: it.max,
            store: it.store,
            default: it.default,
            description: it.description.into(),
        }
    }
}

impl From<&StaticOption> for FitOption {
    fn from(it: &StaticOption) -> Self {
        Self {
            name: it.name.into(),
            unit: it.unit.into(),
            min: it.min,
            max: it.max,
            default: it.default,
            integer: it.integer,
            choices: it.choices.iter().map(|&choice| choice.into()).collect(),
            description: it.description.into(),
        }
    }
}

/// The JSON Schema of a descriptor: `spec/schemas/descriptor-1.json`.
#[cfg(feature = "schemars")]
pub fn descriptor_schema() -> serde_json::Value {
    let title = "descriptor of a texture model, ABI 1";
    htex_schema::document::<Descriptor>("descriptor-1.json", title)
}
