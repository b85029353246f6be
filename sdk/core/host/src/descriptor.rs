//! Checks of a model's descriptor.

use htex_model::abi::MAX_FIELDS;
use htex_model::{Descriptor, Field, FitOption, Kind, is_model_id};

use crate::error::plain;

/// The reason why a descriptor is invalid. Where the error message quotes text of the descriptor,
/// control characters are escaped.
///
/// ```
/// use htex_host::{DescriptorError, read_descriptor};
/// let error = read_descriptor("{}").unwrap_err();
/// assert!(matches!(error, DescriptorError::Json { .. }));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptorError {
    /// The text is not the JSON of a descriptor.
    #[error("{what}")]
    Json {
        /// The parser's message.
        what: String,
    },
    /// The id does not have the form of model ids.
    #[error("`{id}` is not a reverse-DNS id: three or more parts of a-z, 0-9, `-` and `_`")]
    Id { id: String },
    /// The version is not a semantic version.
    #[error("`{version}` is not a semantic version")]
    Version { version: String },
    /// There are no parameter fields, or too many.
    #[error("there are {count} parameter fields; 1 to {MAX_FIELDS} are allowed")]
    FieldCount {
        /// Number of fields.
        count: usize,
    },
    /// The range of a field or fit option is empty or not finite.
    #[error("`{name}` has the invalid range {range}")]
    Range { name: String, range: String },
    /// The default of a field lies outside the field's range, or a list field has a default.
    #[error("`{name}` has a default outside its range, or is a list")]
    Default { name: String },
    /// A name, unit or choice contains control characters.
    #[error("`{text}` has control characters")]
    ControlCharacters { text: String },
    /// The sweep of the fit options has too many combinations.
    #[error("a sweep of the fit options has {count} combinations; {MAX_SWEEP} are allowed")]
    Sweep {
        /// Number of combinations: the number of values of each option, multiplied over all
        /// options. At most `usize::MAX`.
        count: usize,
    },
    /// Two fields have the same name.
    #[error("two fields are named `{name}`")]
    SameName { name: String },
}

/// Largest number of combinations of the options' sweep values, and largest number of values in
/// each list. Without this limit, a descriptor could make a sweep use any amount of memory.
const MAX_SWEEP: usize = 1_000;

/// Reads a descriptor from JSON and checks it. Every loader of models uses this function.
///
/// # Errors
/// Returns a [`DescriptorError`] if the text is not a valid descriptor.
pub fn read_descriptor(json: &str) -> Result<Descriptor, DescriptorError> {
    let descriptor: Descriptor = serde_json::from_str(json)
        .map_err(|error| DescriptorError::Json { what: plain(&error.to_string()) })?;
    check_descriptor(&descriptor)?;
    Ok(descriptor)
}

fn check_descriptor(descriptor: &Descriptor) -> Result<(), DescriptorError> {
    if !is_model_id(&descriptor.id) {
        let id = plain(&descriptor.id);
        return Err(DescriptorError::Id { id });
    }
    if semver::Version::parse(&descriptor.version).is_err() {
        let version = plain(&descriptor.version);
        return Err(DescriptorError::Version { version });
    }
    let count = descriptor.fields.len();
    if !(1..=MAX_FIELDS).contains(&count) {
        return Err(DescriptorError::FieldCount { count });
    }
    let fields = descriptor.fields.iter().map(|f| (&f.name, f.min, f.max));
    let options = descriptor.options.iter().map(|o| (&o.name, o.min, o.max));
    for (name, min, max) in fields.chain(options) {
        if !(min.is_finite() && max.is_finite() && min <= max) {
            return Err(DescriptorError::Range {
                name: plain(name),
                range: format!("{min} to {max}"),
            });
        }
    }
    if let Some(field) = descriptor.fields.iter().find(|field| !default_holds(field)) {
        let name = plain(&field.name);
        return Err(DescriptorError::Default { name });
    }
    let fields = descriptor.fields.iter().flat_map(|f| [&f.name, &f.unit]);
    let options = descriptor
        .options
        .iter()
        .flat_map(|o| o.choices.iter().chain([&o.name, &o.unit]).chain(&o.not_above));
    if let Some(text) = fields.chain(options).find(|w| w.contains(char::is_control)) {
        let text = plain(text);
        return Err(DescriptorError::ControlCharacters { text });
    }
    let together = |all: usize, o: &FitOption| all.saturating_mul(o.sweep.len().max(1));
    let alone = descriptor.options.iter().map(|o| o.sweep_alone.len()).max().unwrap_or(0);
    let count = descriptor.options.iter().fold(1, together).max(alone);
    if count > MAX_SWEEP {
        return Err(DescriptorError::Sweep { count });
    }
    let mut names: Vec<&str> = descriptor.fields.iter().map(|f| f.name.as_str()).collect();
    htex_dsp::order::sort(&mut names);
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(DescriptorError::SameName { name: plain(pair[0]) }),
        None => Ok(()),
    }
}

/// Returns whether a field has no default, or is a scalar whose default is in its range.
fn default_holds(field: &Field) -> bool {
    let inside =
        |value: f64| field.kind == Kind::Scalar && (field.min..=field.max).contains(&value);
    field.default.is_none_or(inside)
}
