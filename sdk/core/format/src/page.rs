//! Generates `spec/validation.md`.

use htex_base::finding::{colophon, rules_page};

use crate::{RULES, STAGES, rules_of};

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
