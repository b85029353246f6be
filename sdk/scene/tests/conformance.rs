//! Generated parts of the specification match the code.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

#[path = "common/cases.rs"]
mod cases;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use cases::{cases, files, plain};
use htex_format::Findings;
use htex_scene::{Limits, RULES, explain, findings_page, read_scene, scene_schema};
use serde_json::Value;

const RENEW: &str = "stale: cargo run -p htex-scene --example scene_pages";

/// Rules that no conformance file breaks: they take a scene of a megabyte, a device with hardware settings
/// (tested in `cli/tests/drive.rs`; the file device has none), or a device that is not connected.
const WITHOUT_FILE: [&str; 3] = ["SCENE_FILE_TOO_LARGE", "DEVICE_HARDWARE", "DEVICE_ABSENT"];

fn spec() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec")
}

#[test]
fn every_scene_gets_its_report_and_every_rule_has_a_scene() {
    let folder = spec().join("scene-conformance");
    let mut expected: BTreeSet<String> = BTreeSet::new();
    let mut raised = BTreeSet::new();
    for (name, bytes) in files() {
        assert_eq!(
            fs::read(folder.join(name)).unwrap(),
            bytes,
            "{name} {RENEW}"
        );
        expected.insert(name.to_owned());
    }
    for case in cases() {
        let [scene, report] = ["scene", "report"].map(|kind| format!("{}.{kind}.json", case.name));
        let read = |name: &str| fs::read_to_string(folder.join(name)).expect(name);
        assert_eq!(read(&scene), case.text, "{scene} {RENEW}");
        assert_eq!(read(&report), case.golden(&folder), "{report} {RENEW}");
        let golden: Value = serde_json::from_str(&read(&report)).unwrap();
        let findings = golden["findings"].as_array().unwrap();
        let codes: BTreeSet<&str> = findings
            .iter()
            .map(|f| f["code"].as_str().unwrap())
            .collect();
        let name = case.name.to_uppercase();
        let is_named = codes.iter().any(|code| name.starts_with(code));
        assert!(
            is_named || codes.is_empty() && name.starts_with("VALID"),
            "{name} gets {codes:?}"
        );
        raised.extend(codes.into_iter().map(str::to_owned));
        expected.extend([scene, report]);
    }
    let names = fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name());
    let found: BTreeSet<String> = names.map(|n| n.into_string().unwrap()).collect();
    assert_eq!(found, expected, "{RENEW}");
    let silent = RULES.iter().filter(|rule| !raised.contains(rule.code));
    assert_eq!(
        silent.map(|rule| rule.code).collect::<Vec<_>>(),
        WITHOUT_FILE
    );
}

#[test]
fn pages_and_schema_are_up_to_date() {
    let page = fs::read_to_string(spec().join("scene-findings.md")).unwrap();
    assert_eq!(page, findings_page(), "{RENEW}");
    let schema = fs::read_to_string(spec().join("schemas/scene-1.json")).unwrap();
    let schema: Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(schema, scene_schema(), "{RENEW}");
    for rule in htex_format::RULES {
        assert!(
            explain(rule.code).is_none(),
            "{} is a code of assets too",
            rule.code
        );
    }
}

#[test]
fn the_text_names_every_key_effect_and_limit() {
    let text = fs::read_to_string(spec().join("scene-1.md")).unwrap();
    let schema = scene_schema().to_string();
    let keys = schema.split("\"properties\":{").skip(1).flat_map(|part| {
        let names = part.split('"').filter(|name| !name.is_empty());
        names.filter(|name| name.chars().all(|c| c.is_ascii_lowercase() || c == '_'))
    });
    let words = [
        "additional",
        "description",
        "type",
        "anyof",
        "items",
        "string",
        "number",
    ];
    for key in keys.filter(|key| key.contains('_') && !words.contains(key)) {
        assert!(
            text.contains(&format!("`{key}`")),
            "{key} is not in the text"
        );
    }
    for effect in htex_scene::file::Effect::ALL {
        assert!(
            text.contains(&format!("`{}`", effect.name())),
            "{}",
            effect.name()
        );
        assert_eq!(serde_json::to_value(effect).unwrap(), effect.name());
    }
    let limits = Limits::default();
    let rows = [
        ("file_bytes", limits.file_bytes),
        ("json_depth", limits.json_depth as u64),
        ("surfaces", limits.surfaces as u64),
    ];
    for (name, value) in rows {
        assert!(
            text.contains(&format!("| `{name}` | {value} |")),
            "{name} {value}"
        );
    }
}

#[test]
fn a_scene_of_a_megabyte_is_refused_and_one_below_is_read() {
    let codes = |bytes: usize| {
        let mut text = plain().to_string();
        text += &" ".repeat(bytes - text.len());
        let mut findings = Findings::default();
        read_scene(text.as_bytes(), &Limits::default(), &mut findings);
        findings
            .into_list()
            .iter()
            .map(|f| f.code.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(codes(1 << 20), Vec::<String>::new());
    assert_eq!(codes((1 << 20) + 1), ["SCENE_FILE_TOO_LARGE"]);
}
