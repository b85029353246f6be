//! What a model says of itself.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

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

/// One number, or a list of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(tag = "type", rename_all = "kebab-case")]
pub enum Kind {
    /// One number.
    Scalar,
    /// From none to `max_len` numbers.
    List {
        /// Most numbers allowed, at most 65,535.
        #[cfg_attr(feature = "schemars", schemars(range(max = 65535)))]
        max_len: u32,
    },
}

/// How a file stores a field's values: `offset + scale·q`, or `exp(offset + scale·q)` when
/// `log` is set, for the integer kinds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(tag = "type", rename_all = "kebab-case")]
pub enum Store {
    /// 64-bit float.
    F64,
    /// 32-bit float.
    F32,
    /// Unsigned 16-bit steps.
    U16 {
        /// Step.
        #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
        scale: f64,
        /// Value at zero.
        offset: f64,
        /// Steps in the logarithm.
        #[serde(default)]
        log: bool,
    },
    /// Unsigned 8-bit steps.
    U8 {
        /// Step.
        #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
        scale: f64,
        /// Value at zero.
        offset: f64,
        /// Steps in the logarithm.
        #[serde(default)]
        log: bool,
    },
    /// Unsigned 8-bit steps of a list, packed by their differences.
    Packed {
        /// Step.
        scale: f64,
        /// Value at zero.
        offset: f64,
        /// Steps in the logarithm.
        #[serde(default)]
        log: bool,
    },
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
    /// Value when nothing is said.
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
    /// Starts a description without fields or options.
    pub fn new(id: &str, name: &str, version: &str, summary: &str) -> Self {
        Self {
            id: id.to_string(),
            name: name.to_string(),
            version: version.to_string(),
            summary: summary.to_string(),
            fields: Vec::new(),
            options: Vec::new(),
            keeps_level: false,
        }
    }

    /// Says that the level of a fit is part of what the model keeps.
    pub fn keeping_level(mut self) -> Self {
        self.keeps_level = true;
        self
    }

    /// Adds a parameter of one number in `min..=max`, stored as 32-bit float unless
    /// [`Self::stored`] says otherwise.
    pub fn scalar(self, name: &str, unit: &str, range: (f64, f64), description: &str) -> Self {
        self.field(name, unit, range, Kind::Scalar, description)
    }

    /// Adds a list parameter of up to `max_len` numbers in `min..=max`.
    pub fn list(
        self,
        name: &str,
        unit: &str,
        range: (f64, f64),
        max_len: u32,
        description: &str,
    ) -> Self {
        self.field(name, unit, range, Kind::List { max_len }, description)
    }

    fn field(
        mut self,
        name: &str,
        unit: &str,
        (min, max): (f64, f64),
        kind: Kind,
        description: &str,
    ) -> Self {
        self.fields.push(Field {
            name: name.to_string(),
            unit: unit.to_string(),
            kind,
            min,
            max,
            store: Store::F32,
            default: None,
            description: description.to_string(),
        });
        self
    }

    /// Says how files store the field added last.
    pub fn stored(mut self, store: Store) -> Self {
        if let Some(field) = self.fields.last_mut() {
            field.store = store;
        }
        self
    }

    /// Says which value the scalar added last has in assets of earlier minor versions.
    pub fn defaulted(mut self, value: f64) -> Self {
        if let Some(field) = self.fields.last_mut() {
            field.default = Some(value);
        }
        self
    }

    /// Adds a numeric fit option.
    pub fn option(
        mut self,
        name: &str,
        unit: &str,
        (min, max): (f64, f64),
        default: f64,
        description: &str,
    ) -> Self {
        self.options.push(FitOption {
            name: name.to_string(),
            unit: unit.to_string(),
            min,
            max,
            default,
            integer: false,
            choices: Vec::new(),
            description: description.to_string(),
        });
        self
    }

    /// Adds a fit option that takes whole numbers.
    pub fn integer_option(
        self,
        name: &str,
        range: (u32, u32),
        default: u32,
        description: &str,
    ) -> Self {
        let range = (f64::from(range.0), f64::from(range.1));
        let mut this = self.option(name, "1", range, f64::from(default), description);
        if let Some(option) = this.options.last_mut() {
            option.integer = true;
        }
        this
    }

    /// Adds a fit option with named choices; the first is the default.
    pub fn choice(self, name: &str, choices: &[&str], description: &str) -> Self {
        let last = choices.len().saturating_sub(1) as f64;
        let mut this = self.option(name, "1", (0.0, last), 0.0, description);
        if let Some(option) = this.options.last_mut() {
            option.integer = true;
            option.choices = choices.iter().map(|c| c.to_string()).collect();
        }
        this
    }

    /// The value each option takes when nothing is said.
    pub fn default_options(&self) -> Vec<f64> {
        self.options.iter().map(|o| o.default).collect()
    }
}

/// The JSON Schema of a descriptor: `spec/schemas/descriptor-1.json`.
#[cfg(feature = "schemars")]
pub fn descriptor_schema() -> serde_json::Value {
    let title = "descriptor of a texture model, ABI 1";
    htex_schema::document::<Descriptor>("descriptor-1.json", title)
}
