//! How signals fluctuate, against numbers computed by an independent program.

use std::path::PathBuf;

use htex_author::recording::{ReadOptions, read_recording};
use htex_author::{
    AssetRequest, Exploration, ModelRequest, Recording, SegmentChoice, SpectrumOptions, Take,
    fit_asset, fluctuation,
};
use htex_dsp::noise::GaussianNoise;
use htex_dsp::random_envelope::RandomEnvelope;
use htex_format::Fluctuation;
use htex_host::Registry;
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

const RATE_HZ: f64 = 2_500.0;

/// White noise that fluctuates, in `axes` perpendicular directions together.
fn noise(strength_db: [f64; 2], seconds: f64, seed: u64, axes: usize) -> Recording {
    let axis = |axis: usize| {
        let mut samples = vec![0.0f32; (seconds * RATE_HZ) as usize];
        GaussianNoise::new(100 * seed + axis as u64).fill(&mut samples);
        RandomEnvelope::new(strength_db, RATE_HZ, seed).apply(&mut samples);
        samples.into_iter().map(f64::from).collect()
    };
    Recording::new("noise", RATE_HZ, (0..axes).map(axis).collect()).unwrap()
}

/// The fluctuation of an asset that is fitted to recordings of one condition.
fn stated(recordings: Vec<Recording>, segments: SegmentChoice) -> Option<Fluctuation> {
    let take = |recording| Take { recording, given: Exploration::default() };
    let takes: Vec<Take> = recordings.into_iter().map(take).collect();
    let registry = Registry::builtin();
    let request = AssetRequest::new("noise")
        .with_models([ModelRequest::new(registry.find("bands").unwrap())])
        .with_spectrum(SpectrumOptions::default().with_segments(segments));
    fit_asset(&takes, &request).unwrap().asset.manifest.fluctuation
}

fn decibels(recordings: Vec<Recording>) -> [f64; 2] {
    stated(recordings, SegmentChoice::Windows).map_or([0.0; 2], Fluctuation::decibels)
}

/// A minute determines both numbers within 25 %, and so do six recordings of 10 s.
#[test]
fn an_envelope_is_recovered_from_the_noise_that_it_multiplies() {
    for wanted in [[3.0, 2.0], [4.0, 3.0], [5.0, 5.0]] {
        let whole = decibels(vec![noise(wanted, 60.0, 1, 1)]);
        let both = decibels(vec![noise(wanted, 60.0, 2, 2)]);
        let parts = (3..9).map(|seed| noise(wanted, 10.0, seed, 1));
        for found in [whole, both, decibels(parts.collect())] {
            println!("{wanted:?} {found:?}");
            for (found, wanted) in found.into_iter().zip(wanted) {
                assert!((found / wanted - 1.0).abs() < 0.25, "{found} {wanted}");
            }
        }
    }
}

/// The envelope is an exponential, so a strong slow part also varies at 8 to 32 Hz.
#[test]
fn an_envelope_of_one_part_is_mostly_found_in_this_part() {
    for (part, wanted) in [[3.0, 0.0], [0.0, 3.0]].into_iter().enumerate() {
        let found = decibels(vec![noise(wanted, 60.0, 1, 1)]);
        println!("{wanted:?} {found:?}");
        assert!((found[part] / 3.0 - 1.0).abs() < 0.35, "{found:?}");
        assert!(found[1 - part] < 0.5 * found[part], "{found:?}");
    }
}

#[test]
fn stationary_noise_does_not_fluctuate() {
    for seed in 1..=10 {
        let found = decibels(vec![noise([0.0; 2], 20.0, seed, 1)]);
        println!("{found:?}");
        assert!(found.into_iter().all(|db| db < 0.5), "{found:?}");
    }
}

/// Short recordings say nothing, and neither do the middles of sweeps.
#[test]
fn what_is_too_short_states_no_fluctuation() {
    let short = noise([6.0, 5.0], 0.9, 1, 1);
    assert_eq!(stated(vec![short], SegmentChoice::Windows), None);
    let mut sweeps = noise([6.0, 5.0], 20.0, 1, 1);
    for (n, x) in sweeps.axes[0].iter_mut().enumerate() {
        // 1.5 s of sliding, 0.5 s of rest.
        *x = if n % 5_000 < 3_750 { 1.0 + 0.1 * *x } else { 0.0 };
    }
    assert_eq!(stated(vec![sweeps], SegmentChoice::Sweeps), None);
}

/// The errors are those of the envelope on halves that it was not estimated from.
#[test]
fn the_error_is_measured_on_second_halves() {
    let errors = |recordings: Vec<Recording>, segments| {
        let stated = stated(recordings, segments).unwrap();
        println!("{stated:?}");
        (stated.held_out_error_db, stated.halves_error_db)
    };
    let windows = SegmentChoice::Windows;
    // Both halves fluctuate alike.
    for (seconds, most_db) in [(60.0, 3.0), (8.0, 6.0)] {
        let (held_out, halves) = errors(vec![noise([4.0, 3.0], seconds, 1, 1)], windows);
        assert!((0.1..most_db).contains(&held_out.unwrap()), "{held_out:?}");
        assert!((0.1..most_db).contains(&halves.unwrap()), "{halves:?}");
    }
    // The second half does not fluctuate.
    let mut changed = noise([5.0, 4.0], 40.0, 1, 2);
    let steady = noise([0.0; 2], 40.0, 2, 2);
    let middle = changed.samples() / 2;
    for (axis, other) in changed.axes.iter_mut().zip(&steady.axes) {
        axis[middle..].copy_from_slice(&other[middle..]);
    }
    let (held_out, halves) = errors(vec![changed.clone()], windows);
    assert!(held_out.unwrap() > 5.0 && halves.unwrap() > 5.0, "{held_out:?} {halves:?}");
    // Averaged by the lengths.
    let alike = noise([5.0, 4.0], 40.0, 3, 2);
    let (_, other) = errors(vec![alike.clone()], windows);
    let (_, both) = errors(vec![changed, alike], windows);
    let mean = 0.5 * (halves.unwrap() + other.unwrap());
    assert!((both.unwrap() - mean).abs() < 1e-9, "{both:?} {mean}");
    // At a low sample rate, there are fewer third octaves.
    let mut slow = noise([4.0, 3.0], 60.0, 1, 1);
    slow.axes[0] = slow.axes[0].chunks_exact(2).map(|pair| pair[0]).collect();
    slow.rate_hz /= 2.0;
    let (held_out, _) = errors(vec![slow], windows);
    assert!(held_out.unwrap() < 4.0, "{held_out:?}");
    assert_eq!(errors(vec![noise([4.0, 3.0], 5.9, 1, 1)], windows), (None, None));
}

/// A level that only follows the finger is the law's, which a player applies itself.
#[test]
fn changes_of_speed_and_force_are_divided_out() {
    let mut recording = noise([0.0; 2], 60.0, 1, 1);
    let samples = recording.samples();
    let swing = |n: usize, hz: f64| {
        let turn = std::f64::consts::TAU * hz * n as f64 / RATE_HZ;
        libm::exp(0.5 * libm::sin(turn))
    };
    let speed: Vec<f64> = (0..samples).map(|n| 80.0 * swing(n, 1.3)).collect();
    let force: Vec<f64> = (0..samples).map(|n| 0.4 * swing(n, 1.1)).collect();
    // The law that is assumed for an unknown contact.
    let law = htex_format::Law::assumed(recording.quantity, htex_format::Contact::Unknown);
    for (n, x) in recording.axes[0].iter_mut().enumerate() {
        *x *= law.level_factor(speed[n] / 80.0, force[n] / 0.4);
    }
    let [moved, _] = decibels(vec![recording.clone()]);
    assert!(moved > 2.0, "{moved}");
    (recording.speed_mm_s, recording.normal_n) = (Some(speed), Some(force));
    let [divided, _] = decibels(vec![recording]);
    assert!(divided < 0.3 * moved, "{divided} {moved}");
}
