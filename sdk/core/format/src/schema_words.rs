//! Parts of the manifest's JSON Schema that types cannot express: patterns, and values that depend
//! on each other.

use schemars::Schema;
use serde_json::{Value, json};

use crate::Quantity;
use crate::archive::{MANIFEST, MIMETYPE};

/// Pattern of a model's id, as [`htex_model::is_model_id`] checks it.
pub(crate) const MODEL_ID: &str = r"^[a-z0-9_-]+(\.[a-z0-9_-]+){2,}$";

/// Pattern of a semantic version (semver.org).
pub(crate) const SEMANTIC_VERSION: &str = concat!(
    r"^(0|[1-9][0-9]*)\.(0|[1-9][0-9]*)\.(0|[1-9][0-9]*)",
    r"(-(0|[1-9][0-9]*|[0-9]*[a-zA-Z-][0-9a-zA-Z-]*)(\.(0|[1-9][0-9]*|[0-9]*[a-zA-Z-][0-9a-zA-Z-]*))*)?",
    r"(\+[0-9a-zA-Z-]+(\.[0-9a-zA-Z-]+)*)?$"
);

/// Pattern of a DOI, as [`crate::check_doi`] checks it.
pub(crate) const DOI: &str = r"^10\.[0-9]{4,9}(\.[0-9]+)*/[!-~]+$";

/// Pattern of an entry's name. Its parts consist of the ASCII characters from space to `~` except
/// `\\`, `:` and `/`. No part is `.` or `..`.
pub(crate) const ENTRY_NAME: &str = concat!(
    r"^(\.?[ -\-0-9;-\[\]-~][ -.0-9;-\[\]-~]*|\.\.[ -.0-9;-\[\]-~]+)",
    r"(/(\.?[ -\-0-9;-\[\]-~][ -.0-9;-\[\]-~]*|\.\.[ -.0-9;-\[\]-~]+))*$"
);

/// Returns the names of the entries that belong to the container itself.
pub(crate) fn own_entries() -> Value {
    json!({ "enum": [MIMETYPE, MANIFEST] })
}

/// Allows other keys next to a variant's key, because a later minor version may add keys.
pub(crate) fn open_variants(schema: &mut Schema) {
    let variants = schema.get_mut("oneOf").and_then(Value::as_array_mut);
    for variant in variants.into_iter().flatten().filter_map(Value::as_object_mut) {
        variant.remove("additionalProperties");
    }
}

/// Returns each quantity with its unit and its largest level.
pub(crate) fn quantities_and_units() -> Value {
    let pair = |quantity: &Quantity| {
        let level = json!({ "level_rms": { "maximum": quantity.largest_level() } });
        let at = json!({ "at": { "items": { "properties": level } } });
        json!({ "properties": {
            "quantity": { "const": quantity.name() },
            "unit": { "const": quantity.unit() },
            "representations": { "items": { "properties": at } },
        } })
    };
    Quantity::ALL.iter().map(pair).collect()
}
