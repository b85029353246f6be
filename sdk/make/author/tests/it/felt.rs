//! Felt differences, compared with an independent program.

use htex_author::{Felt, SpectrumRef, felt};
use htex_dsp::Band;
use htex_dsp::vibrotactile::Listener;
use htex_format::Quantity;
use serde::Deserialize;

#[derive(Deserialize)]
struct Golden {
    frequency_hz: Vec<f64>,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    name: String,
    recorded: Vec<f64>,
    other: Vec<f64>,
    typical: Expected,
    sensitive: Expected,
}

#[derive(Deserialize)]
struct Expected {
    error_db: Vec<f64>,
    error_rms_db: f64,
    largest_error_db: f64,
    total_error_db: f64,
    below: bool,
}

/// The independent program `tests/peers/felt.py` gives the same results within 1e-6 dB. It uses a
/// complex impedance, a threshold in decibels over decades, and bands given by their edges.
#[test]
fn another_program_feels_the_same() {
    let text = include_str!("../../../../../tests/golden/felt.json");
    let golden: Golden = serde_json::from_str(text).unwrap();
    for case in &golden.cases {
        let recorded = SpectrumRef {
            band: Band::TACTILE,
            frequency_hz: &golden.frequency_hz,
            magnitude: &case.recorded,
        };
        let by = |listener| felt(recorded, &case.other, Quantity::LateralForce, &listener);
        agrees(&case.name, &by(Listener::default()), &case.typical);
        agrees(&case.name, &by(Listener::sensitive()), &case.sensitive);
    }
}

fn agrees(name: &str, found: &Felt, expected: &Expected) {
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    let bands = found.error_db.iter().zip(&expected.error_db);
    assert_eq!(found.error_db.len(), expected.error_db.len(), "{name}");
    assert!(bands.into_iter().all(|(a, b)| near(*a, *b)), "{name}: {found:?}");
    assert!(near(found.error_rms_db, expected.error_rms_db), "{name}: {found:?}");
    assert!(near(found.largest_error_db, expected.largest_error_db), "{name}: {found:?}");
    assert!(near(found.total_error_db, expected.total_error_db), "{name}: {found:?}");
    // The other program judges only the difference.
    let judged = found.is_below_difference_threshold();
    assert_eq!(judged, expected.below && !found.is_below_detection_threshold(), "{name}");
}
