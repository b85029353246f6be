//! Code shared by several suites: golden vectors and their tolerances.
#![allow(clippy::unwrap_used, clippy::panic)] // Test code: a failure is a failed test.

pub mod measure;
pub mod surface;

use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::Value;

/// The examples of pages compile.
#[cfg(doctest)]
#[doc = include_str!("../../docs/driving-a-display.md")]
#[doc = include_str!("../../docs/languages.md")]
#[doc = include_str!("../../docs/libraries.md")]
#[doc = include_str!("../../docs/microcontroller.md")]
pub struct Pages;

/// The workspace's folder.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Size of data as a zlib stream at level 9, bytes.
pub fn deflated_bytes(data: &[u8]) -> usize {
    let mut stream = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    stream.write_all(data).unwrap();
    stream.finish().unwrap().len()
}

/// One golden case: an input, the expected output, and its tolerance.
pub struct Golden(Value);

impl Golden {
    /// Returns the case `name` in `golden/FILE.json`.
    pub fn case(file: &str, name: &str) -> Self {
        Self::all(file)
            .into_iter()
            .find(|case| case.name() == name)
            .unwrap_or_else(|| panic!("no case {name} in {file}"))
    }

    /// All cases of a file.
    pub fn all(file: &str) -> Vec<Self> {
        let path = workspace().join("tests/golden").join(file).with_extension("json");
        let text = std::fs::read_to_string(&path).unwrap();
        let json: Value = serde_json::from_str(&text).unwrap();
        json["cases"].as_array().unwrap().iter().cloned().map(Golden).collect()
    }

    pub fn name(&self) -> &str {
        self.0["name"].as_str().unwrap()
    }

    /// A number, or several, in the input.
    pub fn input(&self, key: &str) -> Vec<f64> {
        numbers(&self.0["input"][key])
    }

    /// A number or a word in the input, as text.
    pub fn input_text(&self, key: &str) -> String {
        match &self.0["input"][key] {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        }
    }

    /// Whether the input has this key.
    pub fn has_input(&self, key: &str) -> bool {
        !self.0["input"][key].is_null()
    }

    /// The expected values at a JSON pointer below `expected`. null is NaN.
    pub fn expected(&self, pointer: &str) -> Vec<f64> {
        numbers(self.0["expected"].pointer(pointer).unwrap_or(&Value::Null))
    }

    /// Compares `got` with the expected values: `|got - expected| <= atol + rtol·|expected|`.
    pub fn hold(&self, pointer: &str, got: &[f64]) {
        let expected = self.expected(pointer);
        let tolerance = |key: &str| self.0[key].as_f64().unwrap();
        let (rtol, atol) = (tolerance("rtol"), tolerance("atol"));
        assert_eq!(got.len(), expected.len(), "{} {pointer}: length", self.name());
        for (i, (g, e)) in got.iter().zip(&expected).enumerate() {
            assert!(
                (g - e).abs() <= atol + rtol * e.abs(),
                "{} {pointer}[{i}]: got {g}, expected {e}",
                self.name()
            );
        }
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        Value::Null => vec![f64::NAN],
        number => vec![number.as_f64().unwrap()],
    }
}

/// The smooth test spectrum of the golden vectors, 20 to 1000 Hz in steps of 5 Hz.
pub fn smooth_spectrum(frequency_hz: &[f64]) -> Vec<f64> {
    let curve = |f: f64| {
        0.01 * (-(f / 150.0).ln().powi(2)).exp() + 0.002 * (-((f - 600.0) / 120.0).powi(2)).exp()
    };
    frequency_hz.iter().map(|&f| curve(f)).collect()
}
