//! The analysis against pingouin, statsmodels and SciPy: `tests/golden/study`.
#![allow(clippy::unwrap_used, clippy::panic)] // A failed unwrap is a failed test.

use std::path::Path;

use htex_lab::analyse::{Analysis, Incomplete, Ratings, Spectra, analyse};
use serde_json::Value;

fn golden(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/study");
    std::fs::read(folder.join(name)).unwrap()
}

fn study() -> Analysis {
    let ratings = Ratings::read(&golden("ratings.csv"), Incomplete::Refuse).unwrap();
    let spectra = Spectra::read(&golden("spectra.csv"), &ratings.table).unwrap();
    assert!(ratings.findings.is_empty() && spectra.findings.is_empty());
    analyse(&ratings.table, Some(&spectra.table), "test")
}

/// Compares all values under `expected`, and counts the numbers.
fn agree(expected: &Value, got: &Value, at: &str, tolerance: (f64, f64)) -> usize {
    match expected {
        Value::Object(map) => {
            let pairs = map.iter();
            pairs
                .map(|(key, value)| agree(value, &got[key], &format!("{at}.{key}"), tolerance))
                .sum()
        }
        Value::Array(list) => {
            assert_eq!(got.as_array().map(Vec::len), Some(list.len()), "{at}");
            let pairs = list.iter().enumerate();
            pairs
                .map(|(i, value)| agree(value, &got[i], &format!("{at}.{i}"), tolerance))
                .sum()
        }
        Value::Number(number) => {
            let expected = number.as_f64().unwrap();
            let got = got.as_f64().unwrap_or_else(|| panic!("{at} is missing"));
            let allowed = tolerance.1 + tolerance.0 * expected.abs();
            assert!(
                (got - expected).abs() <= allowed,
                "{at}: {got} is not {expected}"
            );
            1
        }
        other => {
            assert_eq!(other, got, "{at}");
            0
        }
    }
}

#[test]
fn every_number_agrees_with_the_reference_programs() {
    let golden: Value = serde_json::from_slice(&golden("study.json")).unwrap();
    let got = serde_json::to_value(study()).unwrap();
    let tolerance = (
        golden["rtol"].as_f64().unwrap(),
        golden["atol"].as_f64().unwrap(),
    );
    let numbers = agree(&golden["expected"], &got, "", tolerance);
    assert!(numbers > 1000, "{numbers} numbers were compared");
}
