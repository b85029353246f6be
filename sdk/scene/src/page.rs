//! Generation of `spec/scene-findings.md` and `spec/schemas/scene-1.json` from the code.

use htex_finding::rules_page;
use serde_json::Value;

use crate::{RULES, Scene};

const HEAD: &str = "\
# Findings in scenes

Generated from the table of rules in `sdk/scene/src/rules.rs` by
`cargo xtask generate`.

A finding has a code, a severity, a JSON pointer into the scene (empty for the file as a whole) and a
message. A scene can be played when no finding is an error. Codes never change their meaning.
";

/// The page with all rules: `spec/scene-findings.md`.
pub fn findings_page() -> String {
    rules_page(HEAD, RULES)
}

/// The JSON Schema of scenes of version 1.0: `spec/schemas/scene-1.json`.
pub fn scene_schema() -> Value {
    htex_schema::document::<Scene>("scene-1.json", "Scene of htex 1")
}
