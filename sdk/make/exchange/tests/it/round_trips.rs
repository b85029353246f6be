//! Files that are written, read back and written again.

use htex_exchange::haptic::Metadata;
use htex_exchange::hjif::{Space, analysed, synthesised, waveform};
use htex_exchange::{Ahap, Haptic, Hjif, Pattern, Point, Profile, Transient, combined, value_at};
use proptest::collection::vec;
use proptest::prelude::*;

fn profile() -> &'static Profile {
    Profile::find("iphone").unwrap()
}

/// A vibration from 0.2 s on: points some milliseconds apart, and a transient where the level is 1.
fn pattern(steps_ms: &[u32], values: &[f64], hertz: &[f64]) -> Pattern {
    let (mut time_s, mut level) = (0.2, Vec::new());
    for (step, value) in steps_ms.iter().zip(values) {
        level.push(Point::new(time_s, *value));
        time_s += f64::from(*step) / 1e3;
    }
    level.push(Point::new(time_s, 1.0));
    let last = (hertz.len() - 1).max(1) as f64;
    let frequency = |(index, hertz): (usize, &f64)| {
        Point::new(0.2 + index as f64 / last * (time_s - 0.2), *hertz)
    };
    Pattern {
        from_s: 0.2,
        to_s: time_s,
        level,
        exponent: 1,
        frequency_hz: hertz.iter().enumerate().map(frequency).collect(),
        transients: vec![Transient {
            time_s,
            amplitude: 1.0,
            // A control is added to a transient's sharpness, so the sharpness cannot be lower than
            // the control.
            frequency_hz: 300.0,
        }],
    }
}

fn there(pattern: &Pattern) -> Pattern {
    let bytes = Ahap::from_pattern(pattern, profile()).to_bytes();
    combined(&Ahap::from_bytes(&bytes).unwrap().patterns(profile()))
}

fn back(pattern: &Pattern) -> Pattern {
    let bytes = Haptic::from_pattern(pattern, profile(), Metadata::default()).to_bytes();
    Haptic::from_bytes(&bytes).unwrap().pattern(profile())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// From `.ahap` to `.haptic` and back to `.ahap`: level and frequency at each point and the
    /// transient are kept.
    #[test]
    fn ahap_to_haptic_and_back(
        (steps, values, hertz) in (2usize..40).prop_flat_map(|count| (
            vec(1u32..2_000, count),
            vec(0.0f64..=1.0, count),
            vec(65.0f64..=300.0, count),
        ))
    ) {
        let from = pattern(&steps, &values, &hertz);
        let to = there(&back(&there(&from)));
        for (was, is, resolution) in [
            (&from.level, &to.level, 1e-9),
            (&from.frequency_hz, &to.frequency_hz, 1e-6),
        ] {
            for point in was {
                let found = value_at(is, point.time_s).unwrap();
                prop_assert!((found - point.value).abs() < resolution, "{point:?} {found}");
            }
        }
        prop_assert!((to.from_s - from.from_s).abs() < 1e-9 && (to.to_s - from.to_s).abs() < 1e-9);
        prop_assert_eq!(to.transients.len(), 1);
        let (was, is) = (from.transients[0], to.transients[0]);
        prop_assert!((was.time_s - is.time_s).abs() < 1e-9);
        prop_assert!((was.amplitude - is.amplitude).abs() < 1e-6);
        prop_assert!((was.frequency_hz - is.frequency_hz).abs() < 1e-6);
    }

    /// Round trip through `.hjif`: samples coded by wavelets come back within the resolution of
    /// their coefficients, and the file itself comes back exactly.
    #[test]
    fn samples_to_hjif_and_back(samples in vec(-1.0f64..=1.0, 1..3_000), speed in prop::option::of(20.0f64..400.0)) {
        let space = Space { speed_mm_s: speed };
        let file = waveform(&samples, profile(), space, "noise");
        let read = Hjif::from_bytes(&file.to_bytes()).unwrap();
        prop_assert_eq!(&read, &file);
        prop_assert_eq!(read.is_over_space(), speed.is_some());
        let rendered = read.rendered(space.rate_hz(), speed.unwrap_or(1.0)).unwrap();
        prop_assert!(rendered.len() >= samples.len());
        let worst = samples.iter().zip(&rendered).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
        prop_assert!(worst < 4e-3, "{worst}");
        let after = rendered.iter().skip(samples.len());
        prop_assert!(after.into_iter().all(|x| x.abs() < 4e-3));
    }

    #[test]
    fn wavelets_are_inverted(block in (3u32..12).prop_flat_map(|bits| vec(-1.0f64..1.0, 1usize << bits))) {
        let again = synthesised(&analysed(&block));
        let worst = block.iter().zip(&again).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
        prop_assert!(worst < 1e-9, "{worst}");
    }
}

/// The scale matches the reference software: each low-pass of the transform sums to √2.
#[test]
fn a_constant_is_a_low_pass() {
    let coefficients = analysed(&[1.0; 32]);
    for (index, value) in coefficients.iter().enumerate() {
        let expected = if index < 4 { 8f64.sqrt() } else { 0.0 };
        assert!((value - expected).abs() < 1e-6, "{index}: {value}");
    }
}

/// A tone of a vectorial band over space is a sine whose frequency follows the speed.
#[test]
fn a_tone_over_way_follows_the_speed() {
    let text = r#"{"version": "2023", "profile": "Main", "level": 1, "date": "2026", "description": "", "timescale": 10000,
        "avatars": [], "syncs": [], "perceptions": [{"id": 0, "avatar_id": 0, "description": "",
        "perception_modality": "Vibrotactile Texture", "unit_exponent": -3, "effect_library": [], "channels": [{"id": 0,
        "description": "", "gain": 0.5, "mixing_coefficient": 1, "body_part_mask": 0, "bands": [{"band_type": "VectorialWave",
        "lower_frequency_limit": 0, "upper_frequency_limit": 10000, "effects": [{"effect_type": "Basis", "position": 0, "phase": 0,
        "base_signal": "Sine", "keyframes": [
        {"relative_position": 0, "amplitude_modulation": 1, "frequency_modulation": 1000},
        {"relative_position": 1000, "amplitude_modulation": 1, "frequency_modulation": 1000}]}]}]}]}]}"#;
    let file = Hjif::from_bytes(text.as_bytes()).unwrap();
    assert!(file.is_over_space());
    for (speed, hertz) in [(100.0, 100.0), (50.0, 50.0)] {
        let samples = file.rendered(8_000.0, speed).unwrap();
        // A tenth of a metre.
        assert_eq!(samples.len(), (8_000.0 * 100.0 / speed) as usize);
        for (index, sample) in samples.iter().enumerate() {
            let expected = 0.5 * (std::f64::consts::TAU * hertz * index as f64 / 8_000.0).sin();
            assert!((sample - expected).abs() < 1e-6, "{speed} {index}");
        }
    }
}

/// A transient in an `.ahap` before any curve keeps its strength; a transient during a curve is
/// changed by it.
#[test]
fn controls_change_transients_from_their_first_point_on() {
    let text = |time: f64| {
        format!(
            r#"{{"Version": 1, "Pattern": [
            {{"Event": {{"Time": {time}, "EventType": "HapticTransient", "EventParameters": [
                {{"ParameterID": "HapticIntensity", "ParameterValue": 0.8}},
                {{"ParameterID": "HapticSharpness", "ParameterValue": 0.5}}]}}}},
            {{"ParameterCurve": {{"ParameterID": "HapticIntensityControl", "Time": 1, "ParameterCurveControlPoints": [
                {{"Time": 0, "ParameterValue": 0.5}}, {{"Time": 1, "ParameterValue": 1}}]}}}}]}}"#
        )
    };
    for (time, intensity) in [(0.5, 0.8), (1.0, 0.4), (1.5, 0.6), (3.0, 0.8)] {
        let patterns = Ahap::from_bytes(text(time).as_bytes()).unwrap().patterns(profile());
        let amplitude = patterns[0].transients[0].amplitude;
        assert!((amplitude - intensity * intensity).abs() < 1e-12, "{time}");
    }
}
