//! `spec/models` and `spec/playing-conformance` agree with the models.

use crate::common::playing;

use std::fs;
use std::path::PathBuf;

use htex_host::Registry;
use htex_tests::workspace;
use serde_json::Value;
use xtask::generated::{file_with, only};

/// Relative difference that compilers and library versions may cause.
const NEAR: f64 = 1e-9;

#[test]
fn generated_files_are_fresh() {
    let files = playing::files();
    for (path, bytes) in &files {
        file_with(path, bytes, |kept| {
            if path.ends_with(".json") {
                near(&parsed(kept), &parsed(bytes))
            } else {
                kept == bytes
            }
        });
    }
    for folder in [playing::MODELS, playing::CASES] {
        only(folder, files.iter().map(|(path, _)| path.as_str()));
    }
}

fn cases_folder() -> PathBuf {
    workspace().join(playing::CASES)
}

fn parsed(text: &[u8]) -> Value {
    serde_json::from_slice(text).unwrap_or_default()
}

fn near(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            (a - b).abs() <= NEAR * a.abs().max(b.abs()).max(1e-6)
        }
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| near(a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.0 == b.0 && near(a.1, b.1))
        }
        _ => a == b,
    }
}

/// The table of ranges in the text matches the descriptors.
#[test]
fn the_text_has_every_field_and_its_range() {
    let text = fs::read_to_string(workspace().join("spec/htex-playing-1.md")).unwrap();
    let rows: Vec<&str> = text.lines().filter(|line| line.starts_with('|')).collect();
    for model in htex_host::Registry::builtin().models() {
        assert!(text.contains(&format!("| `{}` |", model.id())));
        for field in &model.descriptor().fields {
            let (low, high) = (grouped(field.min), grouped(field.max));
            let range = format!("| {} | {low} | {high} |", field.unit);
            let name = format!("`{}`", field.name);
            let told = |row: &&&str| row.contains(&name) && row.contains(&range);
            let row = rows
                .iter()
                .find(told)
                .copied()
                .unwrap_or_else(|| panic!("{} {name} {range}", model.id()));
            if let htex_host::Kind::List { max_len } = field.kind {
                assert!(row.contains(&format!(" to {max_len} of them")) || row.contains("as many"));
            }
        }
    }
}

/// The registry has exactly the built-in models, each with its major version.
#[test]
fn the_registry_has_every_model() {
    let text = fs::read_to_string(workspace().join("spec/registration.md")).unwrap();
    let (_, rest) = text.split_once("**Models**").unwrap();
    let (table, _) = rest.split_once("**Quantities**").unwrap();
    let rows: Vec<String> = table
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| line.split('|').take(3).collect::<Vec<_>>().join("|"))
        .collect();
    let registry = Registry::builtin();
    let row = |model: &htex_host::LoadedModel| {
        let descriptor = model.descriptor();
        let major = descriptor.version.split('.').next().unwrap_or_default();
        format!("| `{}` | {major} ", descriptor.id)
    };
    let mut expected: Vec<String> = registry.models().iter().map(row).collect();
    expected.sort();
    assert_eq!(rows, expected);
}

/// A number with commas between thousands.
fn grouped(x: f64) -> String {
    if x.abs() < 1000.0 {
        return x.to_string();
    }
    let digits = format!("{:.0}", x.abs());
    let grouped: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|part| std::str::from_utf8(part).unwrap()).collect();
    let sign = if x < 0.0 { "-" } else { "" };
    format!("{sign}{}", grouped.join(","))
}

#[test]
fn every_model_has_cases() {
    let mut counts = std::collections::BTreeMap::new();
    let numbers = playing::files().into_iter();
    for (_, bytes) in numbers.filter(|(path, _)| path.starts_with(playing::CASES)) {
        for case in parsed(&bytes)["cases"].as_array().into_iter().flatten() {
            *counts.entry(case["model"].to_string()).or_insert(0) += 1;
        }
    }
    assert_eq!(counts.len(), Registry::builtin_names().len());
    assert!(counts.values().sum::<i32>() >= 200, "{counts:?}");
}

/// Valid files that this player cannot play: one embeds an empty module, two are of a newer version
/// of their model, and two have all their energy between two bins.
const NOT_PLAYED: [&str; 5] = [
    "valid_plugin.htex",
    "valid_field_of_newer_model.htex",
    "valid_other_major_of_model.htex",
    "valid_reference_rounded.htex",
    "valid_band_to_20_khz.htex",
];

/// Valid files can be played.
#[test]
fn valid_conformance_files_are_played() {
    let folders = [workspace().join("spec/conformance"), cases_folder()];
    let mut played = 0;
    for entry in folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap()) {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let sound = name.starts_with("valid") || path.starts_with(cases_folder());
        // Of these assets a player refuses parameters, or a model.
        let refused = name.starts_with("refused");
        if !sound || refused || !name.ends_with(".htex") || NOT_PLAYED.contains(&&name[..]) {
            continue;
        }
        let asset = htex::Texture::open(&path).unwrap();
        let representations = asset.manifest().representations.iter();
        // Other models do not exist.
        for representation in representations.filter(|r| r.model.starts_with("org.htex.")) {
            let mut out = [0.0f32; 2_000];
            let playable = asset.representation(&representation.model[..]).unwrap();
            let rate_hz = (2.0 * asset.band().high_hz).max(20_000.0);
            let voice = playable.voice(&htex::VoiceOptions::default().with_rate_hz(rate_hz));
            let rendered = voice.and_then(|mut voice| voice.render(&mut out));
            rendered.unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(out.iter().any(|&x| x != 0.0), "{name} is silent");
            played += 1;
        }
    }
    assert!(played >= 40, "{played} representations");
}
