//! The conformance files, their reports, the page of findings and the schemas in `spec/`.

use crate::common;

use std::collections::BTreeSet;

use common::cases::cases;
use htex_base::finding::{Finding, Report, Rule, Severity, Stage};
use htex_format::{
    Asset, RULES, STAGES, manifest_json, manifest_schema, report_schema, validation_page,
};
use xtask::generated::{file, file_with, folder};

/// Codes that only `htex validate` reports, because it uses JSON Schemas and loads models.
const WITHOUT_FILE: [&str; 4] =
    ["PLUGIN_UNUSABLE", "SCHEMA_BROKEN", "EXTENSION_SCHEMA_BROKEN", "DESCRIPTOR_INVALID"];

#[test]
fn generated_files_and_their_reports_are_fresh() {
    let mut files = Vec::new();
    for case in cases() {
        let path = |end: &str| format!("spec/conformance/{}.{end}", case.name);
        files.push((path("report.json"), case.golden().into_bytes()));
        files.push((path("htex"), case.bytes));
    }
    folder("spec/conformance", &files);
}

/// The codes of a report on a file, which is named after one of them, or is valid and named so.
pub fn codes_of(name: &str, report: &Report) -> BTreeSet<String> {
    let codes: BTreeSet<String> = report.findings.iter().map(|f| f.code.clone()).collect();
    let name = name.to_uppercase();
    let named = codes.iter().any(|code| name.starts_with(code.as_str()));
    assert!(named || name.starts_with("VALID"), "{name} gets {codes:?}");
    assert!(report.valid || !name.starts_with("VALID"), "{name}: {:?}", report.findings);
    codes
}

#[test]
fn a_file_is_named_after_the_rule_it_breaks_and_every_rule_has_one() {
    let mut raised = BTreeSet::new();
    for case in cases() {
        let report = case.report();
        raised.extend(codes_of(&case.name, &report));
        // A reader without models cannot detect wrong fields.
        let by_model = ["FIELD_UNKNOWN", "FIELD_MISSING", "FIELD_KIND_WRONG", "FIELD_UNIT_WRONG"];
        let mut errors = report.findings.iter().filter(|f| f.severity == Severity::Error);
        assert_eq!(
            Asset::from_bytes_with(&case.bytes, &case.limits).is_ok(),
            errors.all(|f| by_model.contains(&f.code.as_str()))
        );
    }
    let silent = RULES.iter().filter(|rule| !raised.contains(rule.code));
    let silent: Vec<&str> = silent.map(|rule| rule.code).collect();
    assert_eq!(silent, WITHOUT_FILE);
}

#[test]
fn generated_page_and_schemas_are_fresh() {
    file("spec/validation.md", validation_page().as_bytes());
    for (name, schema) in [("manifest-1", manifest_schema()), ("report-1", report_schema())] {
        let text = serde_json::to_string_pretty(&schema).unwrap() + "\n";
        let path = format!("spec/schemas/{name}.json");
        file_with(path, text.as_bytes(), |kept| {
            serde_json::from_slice::<serde_json::Value>(kept).unwrap() == schema
        });
    }
}

#[test]
fn a_newer_minor_version_is_noted_and_kept() {
    let newer = cases().into_iter().find(|c| c.name == "valid_newer_minor").unwrap();
    let asset = Asset::from_bytes(&newer.bytes).unwrap();
    assert_eq!(asset.notes[0].code, "VERSION_NEWER");
    assert!(asset.manifest.other.contains_key("friction"));
    assert_eq!(Asset::from_bytes(&asset.to_bytes().unwrap()).unwrap(), asset);
}

/// Returns the stages of the findings' codes. Each stage is the stage of the finding before it, or
/// a later one.
fn stages_of(findings: &[Finding]) -> Vec<usize> {
    let mut at = 0;
    let mut places = Vec::new();
    for finding in findings {
        let rule = RULES.iter().find(|rule| rule.code == finding.code).unwrap();
        let here = |stage: &Stage| rule.stages.contains(stage);
        let later = STAGES[at..].iter().position(here);
        at += later.unwrap_or_else(|| panic!("{} is out of order", finding.code));
        places.push(at);
    }
    places
}

#[test]
fn findings_stand_in_the_order_of_the_stages_and_end_where_a_stage_ends() {
    for case in cases() {
        let findings = case.report().findings;
        let stages = stages_of(&findings);
        let error = |i: &usize| findings[*i].severity == Severity::Error;
        let mut errors = (0..findings.len()).filter(error);
        let ends = errors.find(|i| STAGES[stages[*i]].ends);
        let last = *stages.last().unwrap_or(&0);
        assert!(ends.is_none_or(|i| stages[i] == last), "{}: {findings:?}", case.name);
    }
    let staged = |rule: &&Rule| rule.stages.iter().any(|stage| STAGES.contains(stage));
    assert!(RULES.iter().all(|rule| staged(&rule)));
}

#[test]
fn pointers_lead_to_values_of_the_manifest() {
    let mut led = 0;
    for case in cases() {
        let Some(manifest) = manifest_json(&case.bytes, &case.limits) else {
            continue;
        };
        for finding in case.report().findings {
            let value = manifest.pointer(&finding.pointer);
            assert!(value.is_some(), "{}: {}", case.name, finding.pointer);
            led += usize::from(!finding.pointer.is_empty());
        }
    }
    assert!(led > 50, "{led}");
}
