//! The published pages and schemas of analyses.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use htex_lab::analyse::{analysis_schema, findings_page};

#[test]
fn generated_files_are_fresh() {
    let schema = format!("{:#}\n", analysis_schema());
    xtask::generated::file("spec/schemas/study-analysis-1.json", schema.as_bytes());
    xtask::generated::file("spec/analysis-findings.md", findings_page().as_bytes());
}
