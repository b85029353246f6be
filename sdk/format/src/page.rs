//! `spec/validation.md` and `spec/schemas/manifest-1.json`, made from the code.

use std::fmt::Write;

use serde_json::Value;

use crate::{Manifest, RULES, Rule};

const HEAD: &str = "\
# Findings of validation

Generated from the table of rules in `sdk/format/src/rules.rs` by
`cargo run -p htex-format --example conformance`.

A finding has a code, a severity, a JSON pointer into the manifest (empty for the file as a whole)
and a message. An asset is valid when no finding is an error. Codes never change their meaning.
";

/// The page that explains every rule: `spec/validation.md`.
pub fn validation_page() -> String {
    rules_page(HEAD, RULES)
}

/// A page that explains rules: `head`, a table of all codes, then each rule.
pub fn rules_page(head: &str, rules: &[Rule]) -> String {
    let mut page = format!("{head}\n| code | severity | what was found |\n|---|---|---|\n");
    for rule in rules {
        let anchor = rule.code.to_ascii_lowercase();
        let Rule {
            code,
            severity,
            summary,
            ..
        } = rule;
        push(
            &mut page,
            format_args!("| [{code}](#{anchor}) | {severity} | {summary} |\n"),
        );
    }
    for rule in rules {
        push(
            &mut page,
            format_args!(
                "\n## {}\n\n{}: {}\n\n",
                rule.code, rule.severity, rule.summary
            ),
        );
        push(
            &mut page,
            format_args!("{}\n\n**What to do:** {}\n", rule.explanation, rule.fix),
        );
    }
    page
}

fn push(page: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = page.write_fmt(text);
}

/// The JSON Schema of `manifest.json`: `spec/schemas/manifest-1.json`.
pub fn manifest_schema() -> Value {
    htex_schema::document::<Manifest>("manifest-1.json", "manifest.json of an htex 1 asset")
}
