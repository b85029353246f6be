//! The generated files under `spec/` are up to date.
#![allow(clippy::expect_used, clippy::unwrap_used, clippy::panic)]

mod common;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use common::cases::cases;
use htex_format::{
    Asset, Finding, RULES, STAGES, Severity, Stage, explain, manifest_json, manifest_schema,
    report_schema, validation_page,
};

const RENEW: &str = "stale: cargo run -p htex-format --example conformance";

/// Codes that only `htex validate` reports, with JSON Schemas and by loading models.
const WITHOUT_FILE: [&str; 4] = [
    "PLUGIN_UNUSABLE",
    "SCHEMA_BROKEN",
    "EXTENSION_SCHEMA_BROKEN",
    "DESCRIPTOR_INVALID",
];

fn spec() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec")
}

#[test]
fn every_file_gets_its_report() {
    let folder = spec().join("conformance");
    let mut expected = BTreeSet::new();
    for case in cases() {
        let [asset, report] = ["htex", "report.json"].map(|e| format!("{}.{e}", case.name));
        assert_eq!(
            fs::read(folder.join(&asset)).expect(&asset),
            case.bytes,
            "{asset} {RENEW}"
        );
        let golden = fs::read_to_string(folder.join(&report)).expect(&report);
        assert_eq!(golden, case.golden(), "{report} {RENEW}");
        expected.extend([asset, report]);
    }
    let names = fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name());
    let found: BTreeSet<String> = names.map(|n| n.into_string().unwrap()).collect();
    assert_eq!(found, expected, "{RENEW}");
}

#[test]
fn a_file_is_named_after_the_rule_it_breaks_and_every_rule_has_one() {
    let mut raised = BTreeSet::new();
    for case in cases() {
        let report = case.report();
        let codes: BTreeSet<String> = report.findings.iter().map(|f| f.code.clone()).collect();
        let name = case.name.to_uppercase();
        let named = codes.iter().any(|code| name.starts_with(code.as_str()));
        assert!(named || name.starts_with("VALID"), "{name} gets {codes:?}");
        assert!(
            report.valid || !name.starts_with("VALID"),
            "{name}: {:?}",
            report.findings
        );
        // A reader without models cannot detect wrong fields.
        let by_model = [
            "FIELD_UNKNOWN",
            "FIELD_MISSING",
            "FIELD_KIND_WRONG",
            "FIELD_UNIT_WRONG",
        ];
        let mut errors = report
            .findings
            .iter()
            .filter(|f| f.severity == Severity::Error);
        assert_eq!(
            Asset::from_bytes_with(&case.bytes, &case.limits).is_ok(),
            errors.all(|f| by_model.contains(&f.code.as_str()))
        );
        raised.extend(codes);
    }
    let silent = RULES.iter().filter(|rule| !raised.contains(rule.code));
    let silent: Vec<&str> = silent.map(|rule| rule.code).collect();
    assert_eq!(silent, WITHOUT_FILE);
    assert!(explain("BAND_INVALID").is_some() && explain("BAND").is_none());
}

#[test]
fn page_and_schema_are_fresh() {
    let page = fs::read_to_string(spec().join("validation.md")).expect("the page is there");
    assert_eq!(page, validation_page(), "{RENEW}");
    let schema = fs::read_to_string(spec().join("schemas/manifest-1.json")).expect("it is there");
    let schema: serde_json::Value = serde_json::from_str(&schema).expect("it is JSON");
    assert_eq!(schema, manifest_schema(), "{RENEW}");
    let schema = fs::read_to_string(spec().join("schemas/report-1.json")).expect("it is there");
    let schema: serde_json::Value = serde_json::from_str(&schema).expect("it is JSON");
    assert_eq!(schema, report_schema(), "{RENEW}");
}

#[test]
fn a_newer_minor_version_is_noted_and_kept() {
    let newer = cases()
        .into_iter()
        .find(|c| c.name == "valid_newer_minor")
        .unwrap();
    let asset = Asset::from_bytes(&newer.bytes).unwrap();
    assert_eq!(asset.notes[0].code, "VERSION_NEWER");
    assert!(asset.manifest.other.contains_key("friction"));
    assert_eq!(
        Asset::from_bytes(&asset.to_bytes().unwrap()).unwrap(),
        asset
    );
}

/// Stages of the findings' codes: each at or after that of the finding before it.
fn stages_of(findings: &[Finding]) -> Vec<usize> {
    let mut at = 0;
    let mut places = Vec::new();
    for finding in findings {
        let here = |stage: &Stage| stage.codes.contains(&finding.code.as_str());
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
        assert!(
            ends.is_none_or(|i| stages[i] == last),
            "{}: {findings:?}",
            case.name
        );
    }
    let named: BTreeSet<&str> = STAGES
        .iter()
        .flat_map(|stage| stage.codes)
        .copied()
        .collect();
    let rules: BTreeSet<&str> = RULES.iter().map(|rule| rule.code).collect();
    assert_eq!(named, rules);
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
