//! A response is compensated in the band of the textures, and only the response's shape matters.

use crate::common;

use common::{constant, file, planned, rendered, scene, single};
use htex_author::{Recording, SegmentChoice, SpectrumOptions, TextureSpectrum, segment_spectra};
use htex_scene::{Renderer, Response};

const RATE_HZ: f64 = 20_000.0;

fn response(frequency_hz: &[f64], magnitude: &[f64]) -> Response {
    Response {
        frequency_hz: frequency_hz.to_vec(),
        magnitude: magnitude.to_vec(),
        phase_rad: vec![0.0; magnitude.len()],
    }
}

/// The output of a newton device over 20 s, and the plan's reason for the compensation.
fn played(response: Option<Response>) -> (Vec<f32>, Option<String>) {
    let mut scene = scene(single(), constant(80.0, 0.4), 20.0);
    scene.file.surfaces[0].representation = "sbeta".to_owned();
    scene.response = response;
    let plan = planned(&scene, &file());
    let mut stages = plan.stages.iter();
    let stage = stages.find(|stage| stage.name == "compensation");
    let reason = stage.map(|stage| stage.reason.clone());
    (rendered(&mut Renderer::new(&scene, &plan).unwrap()), reason)
}

/// Energies from 40 to 200, from 200 to 500, and from 500 to 930 Hz, dB.
fn energies_db(samples: &[f32]) -> [f64; 3] {
    let signal = samples.iter().map(|&x| f64::from(x)).collect();
    let options = SpectrumOptions::default().with_segments(SegmentChoice::Windows);
    let recording = Recording::new("played", RATE_HZ, vec![signal]).unwrap();
    let part = segment_spectra(&recording, &options).unwrap();
    let spectrum = TextureSpectrum::average(&[part], options.averaging).unwrap();
    [(40.0, 200.0), (200.0, 500.0), (500.0, 930.0)].map(|(low, high)| {
        let bins = spectrum.frequency_hz.iter().zip(&spectrum.magnitude);
        let inside = bins.filter(|(f, _)| (low..high).contains(*f));
        10.0 * inside.map(|(_, m)| m * m).sum::<f64>().log10()
    })
}

#[test]
fn a_response_in_another_unit_changes_nothing() {
    let flat = |magnitude| played(Some(response(&[20.0, 1_000.0], &[magnitude; 2]))).0;
    let (one, thousand) = (flat(1.0), flat(1_000.0));
    assert_eq!(one, thousand);
    for (a, b) in energies_db(&played(None).0).iter().zip(energies_db(&one)) {
        assert!((a - b).abs() < 0.2, "{a} and {b} dB");
    }
}

#[test]
fn the_response_outside_the_band_does_not_matter() {
    let steps = response(
        &[0.0, 10.0, 15.0, 200.0, 201.0, 500.0, 501.0, 1_000.0],
        &[1_000.0, 1_000.0, 1.0, 1.0, 0.4, 0.4, 0.1, 0.1],
    );
    let (plain, none) = played(None);
    let (compensated, reason) = played(Some(steps));
    let (plain, compensated) = (energies_db(&plain), energies_db(&compensated));
    for (i, raised_db) in [0.0, 7.96, 20.0].into_iter().enumerate() {
        let found_db = compensated[i] - plain[i];
        assert!((found_db - raised_db).abs() < 0.4, "{i}: {found_db} dB");
    }
    assert_eq!(none, None);
    let reason = reason.unwrap();
    assert!(reason.contains("505 to 1000 Hz by up to 19.9 dB"), "{reason}");
}
