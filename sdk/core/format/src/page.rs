//! Generates `spec/validation.md`, and the schemas of `spec/schemas` that this crate defines.

use htex_base::finding::{FileReport, colophon, rules_page};
use serde_json::Value;

use crate::{Appearance, Manifest, RULES, STAGES, rules_of};

const HEAD: &str = "\
# Findings of validation

A finding has a code, a severity, a JSON pointer into the manifest (empty for the file as a whole)
and a message. An asset is valid when no finding is an error. The meaning of a code never changes.
[htex-reports-1.md](htex-reports-1.md) specifies reports.

## Stages

A reader goes through these stages in order. After an error in a stage that ends the reading, the later
stages are skipped.

";

/// Generates `spec/validation.md`, the page that lists all rules.
pub fn validation_page() -> String {
    let mut head = format!("{HEAD}| stage | findings | errors end the reading |\n|---|---|---|\n");
    for stage in STAGES {
        let ends = if stage.ends { "yes" } else { "no" };
        let codes: Vec<String> = rules_of(*stage).map(|rule| format!("`{}`", rule.code)).collect();
        head += &format!("| {} | {} | {ends} |\n", stage.of, codes.join(", "));
    }
    head += "\n## Codes\n";
    rules_page(&head, RULES) + &colophon("sdk/core/format/src/rules.rs")
}

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
