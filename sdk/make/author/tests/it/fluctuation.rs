//! How signals fluctuate, against numbers computed by an independent program.

use std::path::PathBuf;

use htex_author::fluctuation;
use htex_author::recording::{ReadOptions, read_recording};
use serde::Deserialize;

#[derive(Deserialize)]
struct Golden {
    rate_hz: f64,
    signals: std::collections::BTreeMap<String, Expected>,
}

#[derive(Deserialize)]
struct Expected {
    #[serde(rename = "modulation_db_mean_of_bands_then_bands_own")]
    modulation_db: Vec<f64>,
}

/// Stationary noise, modulated noise, repeated noise and noise with clicks.
#[test]
fn modulation_spectra_agree_with_another_program() {
    let folder =
        PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tests/golden/fluctuation"));
    let text = std::fs::read_to_string(folder.join("expected.json")).unwrap();
    let golden: Golden = serde_json::from_str(&text).unwrap();
    assert_eq!(golden.signals.len(), 6);
    for (name, expected) in golden.signals {
        let file = folder.join(format!("{name}.wav"));
        let recording = read_recording(&file, &ReadOptions::default()).unwrap();
        assert_eq!(recording.rate_hz, golden.rate_hz);
        let found = fluctuation(&recording).unwrap();
        let modulation = found.together_db.iter().chain(&found.own_db);
        for (got, expected) in modulation.zip(&expected.modulation_db) {
            assert!((got - expected).abs() <= 0.02, "{name}: {found:?}");
        }
        // Modulation moves all bands together and makes large samples more frequent. Clicks do only
        // the second.
        let is_modulated = name.starts_with("modulated");
        let makes_peaks = is_modulated || name == "clicks_6_sigma";
        assert_eq!(found.kurtosis > 3.2, makes_peaks, "{name}: {found:?}");
        let together = found.envelope_correlation.unwrap();
        assert_eq!(together > 0.15, is_modulated, "{name}: {found:?}");
    }
}
