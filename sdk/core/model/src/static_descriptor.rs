//! The descriptor as constants in a model's code. At compile time,
//! [`export_model!`](crate::export_model) turns it into the JSON text that the ABI returns.

use crate::{Kind, Store, UsualRange};

/// A model's description: its id, version, parameter fields and fit options.
///
/// ```
/// use htex_model::{StaticDescriptor, StaticField, StaticOption};
/// const DESCRIPTOR: StaticDescriptor =
///     StaticDescriptor::new("org.example.x", "X", "1.0.0", "An example.")
///         .fields(&[StaticField::scalar("peak_hz", "Hz", (20.0, 1000.0), "Peak.")])
///         .options(&[StaticOption::integer("points", (3, 64), 10, "Peaks that are fitted.")]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct StaticDescriptor {
    /// Reverse-DNS identifier, e.g. `org.htex.sbeta`; never changes.
    pub id: &'static str,
    /// Display name, e.g. `sBeta`.
    pub name: &'static str,
    /// Semantic version of the model's parameters and sound.
    pub version: &'static str,
    /// One sentence that says which properties of a spectrum the model stores.
    pub summary: &'static str,
    /// Parameter fields, in their order in the flat parameter array.
    pub fields: &'static [StaticField],
    /// Fit options, in the order in which a fit receives their values.
    pub options: &'static [StaticOption],
    /// Whether the parameters determine the level of a fit. If true, hosts store the fitted level
    /// unchanged.
    pub keeps_level: bool,
    /// Whether hosts use the model only if the user names it. If false, hosts also fit this model
    /// when the user names no model.
    pub only_named: bool,
}

/// One parameter field.
#[derive(Debug, Clone, Copy)]
pub struct StaticField {
    /// Name, including the unit, e.g. `peak_hz`.
    pub name: &'static str,
    /// Unit symbol; `1` for a pure number.
    pub unit: &'static str,
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
    pub default: Option<f64>,
    /// Range of a slider for this field. It lies within `min` to `max`.
    pub usual: Option<UsualRange>,
    /// Meaning of the field.
    pub description: &'static str,
}

/// One fit option. The value of the option is a number. If the option has named choices, this
/// number is the index of a choice.
#[derive(Debug, Clone, Copy)]
pub struct StaticOption {
    /// Name of the option on the command line.
    pub name: &'static str,
    /// Unit symbol; `1` for a pure number.
    pub unit: &'static str,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
    /// Default value.
    pub default: f64,
    /// Whether only whole numbers are allowed.
    pub integer: bool,
    /// Names of the choices 0, 1, …; empty if the option is a plain number.
    pub choices: &'static [&'static str],
    /// A sweep of accuracy against cost (`htex tradeoff`) tries these values of the option. The
    /// sweep tries all combinations of the `sweep` values of all options. For named choices, the
    /// values are their indices.
    pub sweep: &'static [f64],
    /// Values that a sweep tries while all other options have their default values.
    pub sweep_alone: &'static [f64],
    /// Name of another option that limits this one. A value of this option above the other option's
    /// value has no effect, and a sweep skips such values.
    pub not_above: Option<&'static str>,
    /// Says what the option does, and where its default value comes from.
    pub description: &'static str,
}

impl StaticDescriptor {
    /// Makes a descriptor without fields or options.
    pub const fn new(
        id: &'static str,
        name: &'static str,
        version: &'static str,
        summary: &'static str,
    ) -> Self {
        Self {
            id,
            name,
            version,
            summary,
            fields: &[],
            options: &[],
            keeps_level: false,
            only_named: false,
        }
    }

    /// Sets the parameter fields, 1 to 32.
    pub const fn fields(self, fields: &'static [StaticField]) -> Self {
        Self { fields, ..self }
    }

    /// Sets the fit options.
    pub const fn options(self, options: &'static [StaticOption]) -> Self {
        Self { options, ..self }
    }

    /// Declares that the parameters determine the level of a fit.
    pub const fn keeping_level(self) -> Self {
        Self { keeps_level: true, ..self }
    }

    /// Declares that hosts use the model only if the user names it.
    pub const fn only_named(self) -> Self {
        Self { only_named: true, ..self }
    }
}

impl StaticField {
    /// A field with one number in `min..=max`. It is stored as a 32-bit float, unless
    /// [`Self::stored`] sets another encoding.
    pub const fn scalar(
        name: &'static str,
        unit: &'static str,
        (min, max): (f64, f64),
        description: &'static str,
    ) -> Self {
        Self {
            name,
            unit,
            kind: Kind::Scalar,
            min,
            max,
            store: Store::F32,
            default: None,
            usual: None,
            description,
        }
    }

    /// A field with a list of up to `max_len` numbers in `min..=max`.
    pub const fn list(
        name: &'static str,
        unit: &'static str,
        range: (f64, f64),
        max_len: u32,
        description: &'static str,
    ) -> Self {
        Self { kind: Kind::List { max_len }, ..Self::scalar(name, unit, range, description) }
    }

    /// Sets the encoding of the values in an asset.
    pub const fn stored(self, store: Store) -> Self {
        Self { store, ..self }
    }

    /// Sets the field's default value. It is used for an asset that was written by an earlier minor
    /// version of the model, without this field. Only for scalars.
    pub const fn defaulted(self, value: f64) -> Self {
        Self { default: Some(value), ..self }
    }

    /// Sets the usual range of the field, which is the range of its slider.
    pub const fn usual(self, range: UsualRange) -> Self {
        Self { usual: Some(range), ..self }
    }
}

impl StaticOption {
    /// An option that is a number in `min..=max`.
    pub const fn number(
        name: &'static str,
        unit: &'static str,
        (min, max): (f64, f64),
        default: f64,
        description: &'static str,
    ) -> Self {
        Self {
            name,
            unit,
            min,
            max,
            default,
            integer: false,
            choices: &[],
            sweep: &[],
            sweep_alone: &[],
            not_above: None,
            description,
        }
    }

    /// An option that is a whole number in `min..=max`.
    pub const fn integer(
        name: &'static str,
        (min, max): (u32, u32),
        default: u32,
        description: &'static str,
    ) -> Self {
        Self {
            integer: true,
            ..Self::number(name, "1", (min as f64, max as f64), default as f64, description)
        }
    }

    /// An option with several named choices; the first is the default.
    pub const fn choice(
        name: &'static str,
        choices: &'static [&'static str],
        description: &'static str,
    ) -> Self {
        let last = choices.len().saturating_sub(1) as f64;
        Self { integer: true, choices, ..Self::number(name, "1", (0.0, last), 0.0, description) }
    }

    /// Sets the values that a sweep of accuracy against cost (`htex tradeoff`) tries, from coarse
    /// to fine. The sweep tries all combinations of these values with the sweep values of the other
    /// options. If an option has named choices, its values are their indices. If a model has no
    /// option with sweep values, the sweep covers the ranges of all options.
    pub const fn sweep(self, values: &'static [f64]) -> Self {
        Self { sweep: values, ..self }
    }

    /// Sets the values that a sweep tries while all other options have their default values.
    pub const fn sweep_alone(self, values: &'static [f64]) -> Self {
        Self { sweep_alone: values, ..self }
    }

    /// Names another option that limits this one. Values of this option above the other option's
    /// value have no effect.
    pub const fn not_above(self, option: &'static str) -> Self {
        Self { not_above: Some(option), ..self }
    }
}

/// Returns whether `id` is a valid model id: three or more parts, separated by dots. Each part
/// consists of one or more of the characters `a-z`, `0-9`, `-` and `_`.
///
/// ```
/// assert!(htex_model::is_model_id("org.example.my-model_2"));
/// assert!(!htex_model::is_model_id("org.example.MyModel"));
/// assert!(!htex_model::is_model_id("org..model"));
/// ```
pub fn is_model_id(id: &str) -> bool {
    let allowed = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-' || b == b'_';
    let word = |part: &str| !part.is_empty() && part.bytes().all(allowed);
    id.split('.').count() >= 3 && id.split('.').all(word)
}
