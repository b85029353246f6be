//! Generates the schemas of `spec/schemas` that this crate defines.

use htex_base::finding::FileReport;
use serde_json::Value;

use crate::{Appearance, Manifest};

/// Generates the JSON Schema of `manifest.json`: `spec/schemas/manifest-1.json`.
pub fn manifest_schema() -> Value {
    htex_base::schema::document::<Manifest>("manifest-1.json", "manifest.json of an htex 1 asset")
}

/// Generates the JSON Schema of a validation report: `spec/schemas/report-1.json`.
pub fn report_schema() -> Value {
    htex_base::schema::document::<FileReport>(
        "report-1.json",
        "report of validation of an htex file",
    )
}

/// Generates the JSON Schema of the extension `org.htex.appearance/1`:
/// `spec/schemas/appearance-1.json`.
pub fn appearance_schema() -> Value {
    let title = "extension org.htex.appearance/1 of htex assets";
    htex_base::schema::document::<Appearance>("appearance-1.json", title)
}
