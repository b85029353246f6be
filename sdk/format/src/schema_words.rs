//! What the manifest's JSON Schema says beyond types: patterns, and values that belong together.

use schemars::Schema;
use serde_json::{Value, json};

use crate::Quantity;
use crate::validate::{MANIFEST, MIMETYPE};

/// A model's id, as [`htex_model::is_model_id`] has it.
pub(crate) const MODEL_ID: &str = r"^[a-z0-9_-]+(\.[a-z0-9_-]+){2,}$";

/// A semantic version (semver.org).
pub(crate) const SEMANTIC_VERSION: &str = concat!(
    r"^(0|[1-9][0-9]*)\.(0|[1-9][0-9]*)\.(0|[1-9][0-9]*)",
    r"(-(0|[1-9][0-9]*|[0-9]*[a-zA-Z-][0-9a-zA-Z-]*)(\.(0|[1-9][0-9]*|[0-9]*[a-zA-Z-][0-9a-zA-Z-]*))*)?",
    r"(\+[0-9a-zA-Z-]+(\.[0-9a-zA-Z-]+)*)?$"
);

/// A DOI, as [`crate::check_doi`] has it.
pub(crate) const DOI: &str = r"^10\.[0-9]{4,9}(\.[0-9]+)*/[!-~]+$";

/// The name of an entry: parts of ASCII characters from space to `~`, without `\\`, `:` and `/`.
pub(crate) const ENTRY_NAME: &str = r"^[ -.0-9;-\[\]-~]+(/[ -.0-9;-\[\]-~]+)*$";

/// The names that entries of the container itself have.
pub(crate) fn own_entries() -> Value {
    json!({ "enum": [MIMETYPE, MANIFEST] })
}

/// Lets other keys stand beside that of a variant: a later minor version may have more.
pub(crate) fn open_variants(schema: &mut Schema) {
    let variants = schema.get_mut("oneOf").and_then(Value::as_array_mut);
    for variant in variants
        .into_iter()
        .flatten()
        .filter_map(Value::as_object_mut)
    {
        variant.remove("additionalProperties");
    }
}

/// Each quantity with its unit and its largest level.
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
