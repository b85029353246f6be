//! What a host holds a model's description to.

use htex_model::abi::MAX_FIELDS;
use htex_model::{Descriptor, Field, Kind, is_model_id};

use crate::error::plain;

/// Reads a descriptor, as JSON, as every loader does.
///
/// # Errors
/// Why it describes no model that can be called.
pub fn read_descriptor(json: &str) -> Result<Descriptor, String> {
    let descriptor: Descriptor = serde_json::from_str(json).map_err(|e| plain(&e.to_string()))?;
    check_descriptor(&descriptor).map_err(|what| plain(&what))?;
    Ok(descriptor)
}

fn check_descriptor(descriptor: &Descriptor) -> Result<(), String> {
    if !is_model_id(&descriptor.id) {
        return Err(format!(
            "`{}` is not a reverse-DNS id: three or more parts of a-z, 0-9, `-` and `_`",
            descriptor.id
        ));
    }
    if semver::Version::parse(&descriptor.version).is_err() {
        return Err(format!(
            "`{}` is not a semantic version",
            descriptor.version
        ));
    }
    if descriptor.fields.is_empty() || descriptor.fields.len() > MAX_FIELDS {
        return Err(format!("1 to {MAX_FIELDS} parameter fields are allowed"));
    }
    let fields = descriptor.fields.iter().map(|f| (&f.name, f.min, f.max));
    let options = descriptor.options.iter().map(|o| (&o.name, o.min, o.max));
    for (name, min, max) in fields.chain(options) {
        if !(min.is_finite() && max.is_finite() && min <= max) {
            return Err(format!("`{name}` has the range {min} to {max}"));
        }
    }
    if let Some(field) = descriptor.fields.iter().find(|field| !default_holds(field)) {
        let name = &field.name;
        return Err(format!(
            "`{name}` has a default outside its range, or is a list"
        ));
    }
    let fields = descriptor.fields.iter().flat_map(|f| [&f.name, &f.unit]);
    let options = descriptor.options.iter();
    let options = options.flat_map(|o| o.choices.iter().chain([&o.name, &o.unit]));
    if let Some(word) = fields.chain(options).find(|w| w.contains(char::is_control)) {
        return Err(format!("`{word}` has control characters"));
    }
    let mut names: Vec<&str> = descriptor.fields.iter().map(|f| f.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(format!("two fields are named `{}`", pair[0])),
        None => Ok(()),
    }
}

/// Whether a default is that of a scalar, and in its range.
fn default_holds(field: &Field) -> bool {
    let inside =
        |value: f64| field.kind == Kind::Scalar && (field.min..=field.max).contains(&value);
    field.default.is_none_or(inside)
}
