//! What `spec/models` and `spec/playing-conformance` hold is what the models are and give, and a reader
//! written from the specification reads it too.
#![allow(clippy::unwrap_used, clippy::panic)] // A failed unwrap is a failed test.

#[path = "common/playing/mod.rs"]
mod playing;

use std::fs;
use std::process::Command;

use htex_tests::workspace;
use serde_json::Value;

/// Relative difference that compilers and versions of a library may make.
const NEAR: f64 = 1e-9;

#[test]
fn the_files_are_fresh() {
    let files = playing::files();
    for (path, bytes) in &files {
        let kept = fs::read(path).unwrap_or_default();
        let fresh = match path.extension().is_some_and(|e| e == "json") {
            true => near(&parsed(&kept), &parsed(bytes)),
            false => kept == *bytes,
        };
        assert!(fresh, "{} is stale: cargo xtask generate", path.display());
    }
    for folder in [playing::models_folder(), playing::cases_folder()] {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            assert!(files.iter().any(|file| file.0 == path), "{path:?} is stale");
        }
    }
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

#[test]
fn every_model_has_cases() {
    let mut counts = std::collections::BTreeMap::new();
    let numbers = playing::files().into_iter();
    for (_, bytes) in numbers.filter(|(path, _)| path.starts_with(playing::cases_folder())) {
        for case in parsed(&bytes)["cases"].as_array().into_iter().flatten() {
            *counts.entry(case["model"].to_string()).or_insert(0) += 1;
        }
    }
    assert_eq!(counts.len(), 6);
    assert!(counts.values().sum::<i32>() >= 200, "{counts:?}");
}

/// Decodes the assets and computes their magnitudes in Python, from the text of the specification.
#[test]
fn a_reader_written_from_the_text_agrees() {
    let python = std::env::var("HTEX_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&python)
        .args(["-c", "import numpy, scipy"])
        .output();
    if !has.is_ok_and(|output| output.status.success()) {
        println!("skipped: {python} with NumPy and SciPy is not there");
        return;
    }
    let output = Command::new(&python)
        .arg(workspace().join("tests/peers/player.py"))
        .arg(playing::cases_folder())
        .output()
        .unwrap();
    print!("{}", String::from_utf8_lossy(&output.stdout));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
}
