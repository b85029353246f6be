//! The descriptor of a model, as a host reads it.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::{Kind, StaticDescriptor, StaticField, StaticOption, Store, UsualRange};

/// The description of a model: its id, version, parameter fields and fit options. The ABI passes it
/// as JSON.
///
/// ```
/// use htex_model::{StaticDescriptor, StaticField, json};
/// const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new("org.example.x", "X", "1.0.0", "An example.")
///     .fields(&[StaticField::scalar("peak_hz", "Hz", (20.0, 1000.0), "Peak.")]);
/// const TEXT: [u8; json::length(&DESCRIPTOR)] = json::text(&DESCRIPTOR);
/// let descriptor: htex_model::Descriptor = serde_json::from_slice(&TEXT)?;
/// assert_eq!((&descriptor.id[..], &descriptor.fields[0].name[..]), ("org.example.x", "peak_hz"));
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(
    feature = "schemars",
    schemars(description = "A model's description; passed through the ABI as JSON.")
)]
pub struct Descriptor {
    /// Reverse-DNS identifier, e.g. `org.htex.sbeta`; never changes.
    #[cfg_attr(
        feature = "schemars",
        schemars(regex(pattern = r"^[a-z0-9_-]+(\.[a-z0-9_-]+){2,}$"))
    )]
    pub id: String,
    /// Display name, e.g. `sBeta`.
    pub name: String,
    /// Semantic version of the model's parameters and sound.
    pub version: String,
    /// One sentence that says which properties of a spectrum the model stores.
    pub summary: String,
    /// Parameter fields, in their order in the flat parameter array.
    #[cfg_attr(feature = "schemars", schemars(length(min = 1, max = 32)))]
    pub fields: Vec<Field>,
    /// Fit options, in the order in which a fit receives their values.
    #[serde(default)]
    pub options: Vec<FitOption>,
    /// Whether the parameters determine the level of a fit, e.g. because they are energies. If
    /// true, hosts store the fitted level unchanged; if false, they may store the recording's level
    /// instead.
    #[serde(default, skip_serializing_if = "is_false")]
    pub keeps_level: bool,
    /// Whether hosts use the model only if the user names it. If false, hosts also fit this model
    /// when the user names no model.
    #[serde(default, skip_serializing_if = "is_false")]
    pub only_named: bool,
}

fn is_false(flag: &bool) -> bool {
    !flag
}

/// One parameter field.
///
/// ```
/// use htex_model::{Field, Kind, Store};
/// let field = Field {
///     name: "peak_hz".to_owned(),
///     unit: "Hz".to_owned(),
///     kind: Kind::Scalar,
///     min: 20.0,
///     max: 1000.0,
///     store: Store::F32,
///     default: None,
///     usual: None,
///     description: "Peak.".to_owned(),
/// };
/// assert!((field.min..=field.max).contains(&80.0));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(description = "One parameter field."))]
pub struct Field {
    /// Name, including the unit, e.g. `peak_hz`.
    pub name: String,
    /// Unit symbol; `1` for a pure number.
    pub unit: String,
    /// Whether the field is one number or a list of numbers.
    pub kind: Kind,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
    /// Encoding of the values in an asset.
    pub store: Store,
    /// Default value of the field. It is used for an asset that was written by an earlier minor
    /// version of the model, without this field. Only for scalars.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<f64>,
    /// Range of a slider for this field. It lies within `min` to `max`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub usual: Option<UsualRange>,
    /// Meaning of the field.
    pub description: String,
}

/// One option of the fit. The value of the option is a number. If the option has named choices,
/// this number is the index of a choice.
///
/// ```
/// use htex_model::FitOption;
/// let option = FitOption {
///     name: "scale".to_owned(),
///     unit: "1".to_owned(),
///     min: 0.0,
///     max: 1.0,
///     default: 0.0,
///     integer: true,
///     choices: vec!["linear".to_owned(), "log".to_owned()],
///     sweep: Vec::new(),
///     sweep_alone: vec![1.0],
///     not_above: None,
///     description: "Scale of the frequency axis.".to_owned(),
/// };
/// assert_eq!(option.choices[option.default as usize], "linear");
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(
    feature = "schemars",
    schemars(
        description = "One option of the fit: a number, or one of several named choices (the number is its index)."
    )
)]
pub struct FitOption {
    /// Name of the option on the command line.
    pub name: String,
    /// Unit symbol; `1` for a pure number.
    pub unit: String,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
    /// Default value.
    pub default: f64,
    /// Whether only whole numbers are allowed.
    #[serde(default)]
    pub integer: bool,
    /// Names of the values 0, 1, …; empty if the option is a plain number.
    #[serde(default)]
    pub choices: Vec<String>,
    /// A sweep of accuracy against cost (`htex tradeoff`) tries these values of the option. The
    /// sweep tries all combinations of the `sweep` values of all options. For named choices, the
    /// values are their indices.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sweep: Vec<f64>,
    /// Values that a sweep tries while all other options have their default values.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sweep_alone: Vec<f64>,
    /// Name of another option that limits this one. A value of this option above the other option's
    /// value has no effect, and a sweep skips such values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_above: Option<String>,
    /// Says what the option does, and where its default value comes from.
    pub description: String,
}

impl FitOption {
    /// Returns a value as a user writes it: the name of a choice, or the number. Returns `None` if
    /// the value is not allowed.
    ///
    /// ```
    /// use htex_model::{FitOption, StaticOption};
    /// let scale = StaticOption::choice("scale", &["linear", "log"], "Scale.");
    /// assert_eq!(FitOption::from(&scale).text(1.0).as_deref(), Some("log"));
    /// assert_eq!(FitOption::from(&scale).text(2.0), None);
    /// ```
    pub fn text(&self, value: f64) -> Option<String> {
        let is_whole = value as i64 as f64 == value;
        if !(self.min..=self.max).contains(&value) || (self.integer && !is_whole) {
            return None;
        }
        if self.choices.is_empty() {
            return Some(value.to_string());
        }
        self.choices.get(value as usize).cloned()
    }
}

impl Descriptor {
    /// Returns the default of each option.
    pub fn default_options(&self) -> Vec<f64> {
        self.options.iter().map(|o| o.default).collect()
    }

    /// Returns whether the parameters are sinusoids, i.e. whether the fields begin with exactly two
    /// lists, `frequency_hz` and `amplitude`.
    pub fn is_sum_of_sines(&self) -> bool {
        let is_list = |field: &&Field| matches!(field.kind, Kind::List { .. });
        let lists = self.fields.iter().take_while(is_list);
        lists.map(|field| &field.name[..]).eq(["frequency_hz", "amplitude"])
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
            only_named: it.only_named,
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
            usual: it.usual,
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
            sweep: it.sweep.into(),
            sweep_alone: it.sweep_alone.into(),
            not_above: it.not_above.map(Into::into),
            description: it.description.into(),
        }
    }
}

/// Returns the JSON Schema of a descriptor: `spec/schemas/descriptor-1.json`.
#[cfg(feature = "schemars")]
pub fn descriptor_schema() -> serde_json::Value {
    let title = "descriptor of a texture model, ABI 1";
    htex_base::schema::document::<Descriptor>("descriptor-1.json", title)
}
