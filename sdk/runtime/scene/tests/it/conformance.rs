//! The conformance scenes of `spec/` with their reports, the findings page and the schema.

use crate::common::cases;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use cases::{cases, files, plain};
use htex_base::finding::Findings;
use htex_device::{Adapter, SettingKind};
use htex_device_builtin::file::FileAdapter;
use htex_scene::{Limits, RULES, findings_page, read_scene, scene_schema};
use serde_json::Value;
use xtask::generated::{file, file_with, folder};

const FOLDER: &str = "spec/scene-conformance";

/// Rules that no conformance file breaks. Breaking them needs a scene of a megabyte, a device with
/// hardware settings, or a device that is not connected. The file device has no hardware settings;
/// `cli/tests/live/drive.rs` tests them with another device.
const WITHOUT_FILE: [&str; 3] = ["SCENE_FILE_TOO_LARGE", "DEVICE_HARDWARE", "DEVICE_ABSENT"];

/// The specification's folder, relative to this package's folder, in which the tests run.
fn spec() -> &'static Path {
    Path::new("../../../spec")
}

#[test]
fn generated_scenes_and_reports_are_fresh() {
    let path = |name: &str| format!("{FOLDER}/{name}");
    let named = |(name, bytes): (&str, Vec<u8>)| (path(name), bytes);
    let mut all: Vec<_> = files().into_iter().map(named).collect();
    for case in cases() {
        let scene = path(&format!("{}.scene.json", case.name));
        all.push((scene, case.text.as_bytes().to_vec()));
    }
    // The reports are made from the scenes as files, together with the files that they name.
    all.iter().for_each(|(path, bytes)| file(path, bytes));
    for case in cases() {
        let report = path(&format!("{}.report.json", case.name));
        let golden = case.golden(&spec().join("scene-conformance"));
        all.push((report, golden.into_bytes()));
    }
    folder(FOLDER, &all);
}

#[test]
fn scenes_raise_the_code_they_are_named_after_and_every_rule_has_one() {
    let mut raised = BTreeSet::new();
    for case in cases() {
        let golden = case.golden(&spec().join("scene-conformance"));
        let golden: Value = serde_json::from_str(&golden).unwrap();
        let findings = golden["findings"].as_array().unwrap();
        let codes: BTreeSet<&str> = findings.iter().map(|f| f["code"].as_str().unwrap()).collect();
        let name = case.name.to_uppercase();
        let is_named = codes.iter().any(|code| name.starts_with(code));
        assert!(is_named || codes.is_empty() && name.starts_with("VALID"), "{name} gets {codes:?}");
        raised.extend(codes.into_iter().map(str::to_owned));
        // If a file is not valid JSON, its findings concern the whole file.
        let scene: Value = serde_json::from_str(&case.text).unwrap_or_default();
        for finding in findings {
            let pointer = finding["pointer"].as_str().unwrap();
            assert!(scene.pointer(pointer).is_some(), "{name}: {pointer}");
        }
    }
    let silent = RULES.iter().filter(|rule| !raised.contains(rule.code));
    assert_eq!(silent.map(|rule| rule.code).collect::<Vec<_>>(), WITHOUT_FILE);
}

#[test]
fn generated_page_and_schema_are_fresh() {
    file("spec/scene-findings.md", findings_page().as_bytes());
    let schema = serde_json::to_string_pretty(&scene_schema()).unwrap() + "\n";
    file_with("spec/schemas/scene-1.json", schema.as_bytes(), |kept| {
        serde_json::from_slice::<Value>(kept).unwrap() == scene_schema()
    });
}

#[test]
fn the_text_has_every_setting_of_the_adapter_file() {
    let text = fs::read_to_string(spec().join("scene-1.md")).unwrap();
    for setting in &FileAdapter.descriptor().settings {
        let values = match &setting.kind {
            SettingKind::Number { min, max } => format!("{min} to {max}"),
            SettingKind::Choice { values } => format!("`{}`", values.join("`, `")),
            _ => "a file".to_owned(),
        };
        let default = setting.default.as_ref();
        let default = default.map_or(String::new(), |default| format!("`{default}` "));
        let row = format!("\n| `{}` | {values} | {default}| ", setting.name);
        assert!(text.contains(&row), "{row}");
    }
}

/// Returns the cells of a table in the text, row by row, without code marks.
fn rows<'t>(text: &'t str, head: &str) -> Vec<Vec<&'t str>> {
    let (_, rest) = text.split_once(head).unwrap();
    let lines = rest.lines().skip(2).take_while(|line| line.starts_with('|'));
    let cells = |line: &'t str| line.trim_matches('|').split('|').map(str::trim).collect();
    lines.map(cells).collect()
}

#[test]
fn the_columns_of_traces_have_the_names_and_units_of_the_text() {
    let text = fs::read_to_string(spec().join("scene-1.md")).unwrap();
    let rows = rows(&text, "| column | other names | other units |");
    let usual: Vec<&str> = rows.iter().map(|row| row[0].trim_matches('`')).collect();
    let read = |column: usize, name: &str| {
        let mut header = usual.clone();
        header[column] = name;
        let csv = format!("{}\n0,0,0,1,80\n1,80,0,1,80\n", header.join(","));
        htex_recording::trace_from_bytes("hand.csv", csv.as_bytes())
    };
    let mut tried = 0;
    for (column, row) in rows.iter().enumerate() {
        let (base, unit) = usual[column].split_once('_').unwrap();
        let listed = |cell: &str| -> Vec<String> {
            // The names for the axis y are the names for x with y in place of x.
            let x = rows[1][1].replace('x', "y");
            let cell = if cell.starts_with('`') { cell } else { &x };
            cell.split(", ").map(|name| name.trim_matches('`').to_owned()).collect()
        };
        let names = listed(row[1]).into_iter().flat_map(|name| {
            let bracketed =
                [format!("{name} [{unit}]"), format!("{}({unit})", name.to_uppercase())];
            bracketed.into_iter().chain([format!("{name}_{unit}"), name])
        });
        let units = listed(row[2]).into_iter().map(|unit| format!("{base}_{unit}"));
        for name in names.chain(units) {
            let found = read(column, &name).unwrap_or_else(|error| panic!("{name}: {error}"));
            let is_assumed = found.warnings.iter().any(|warning| warning.contains("assumed"));
            assert_eq!(
                found.warnings.len(),
                usize::from(is_assumed),
                "{name}: {:?}",
                found.warnings
            );
            assert_eq!(is_assumed, listed(row[1]).contains(&name), "{name}");
            tried += 1;
        }
    }
    assert_eq!(tried, 132);
}

#[test]
fn the_text_names_every_key_effect_and_limit() {
    let text = fs::read_to_string(spec().join("scene-1.md")).unwrap();
    let schema = scene_schema().to_string();
    let keys = schema.split("\"properties\":{").skip(1).flat_map(|part| {
        let names = part.split('"').filter(|name| !name.is_empty());
        names.filter(|name| name.chars().all(|c| c.is_ascii_lowercase() || c == '_'))
    });
    let words = ["additional", "description", "type", "anyof", "items", "string", "number"];
    for key in keys.filter(|key| key.contains('_') && !words.contains(key)) {
        assert!(text.contains(&format!("`{key}`")), "{key} is not in the text");
    }
    for effect in htex_scene::file::Effect::ALL {
        assert!(text.contains(&format!("`{}`", effect.name())), "{}", effect.name());
        assert_eq!(serde_json::to_value(effect).unwrap(), effect.name());
    }
    let limits = Limits::default();
    let rows = [
        ("file_bytes", limits.file_bytes),
        ("json_depth", limits.json_depth as u64),
        ("surfaces", limits.surfaces as u64),
    ];
    for (name, value) in rows {
        assert!(text.contains(&format!("| `{name}` | {value} |")), "{name} {value}");
    }
}

#[test]
fn a_scene_of_a_megabyte_is_refused_and_one_below_is_read() {
    let codes = |bytes: usize| {
        let mut text = plain().to_string();
        text += &" ".repeat(bytes - text.len());
        let mut findings = Findings::default();
        read_scene(text.as_bytes(), &Limits::default(), &mut findings);
        findings.into_list().iter().map(|f| f.code.clone()).collect::<Vec<_>>()
    };
    assert_eq!(codes(1 << 20), Vec::<String>::new());
    assert_eq!(codes((1 << 20) + 1), ["SCENE_FILE_TOO_LARGE"]);
}
