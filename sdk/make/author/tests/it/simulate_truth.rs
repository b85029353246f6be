//! The true spectrum stated by a simulated surface: recordings of a steady hand have it, an
//! independent computation agrees with it, and a program that reads the file finds it at any speed
//! and force.

use htex_author::simulate::{Departures, FreeMotion, SimulationOptions, Surface, simulate};
use htex_author::{
    Averaging, Exploration, SegmentChoice, SpectrumOptions, Take, TextureSpectrum, segment_take,
};
use htex_dsp::fidelity::third_octave_error_rms_db;

fn free(surface: Surface) -> SimulationOptions {
    SimulationOptions::new(surface).with_free_motion(FreeMotion::default())
}

/// The recording of a hand that keeps its speed and force has the true spectrum, on all surfaces
/// and with departures from a relief.
#[test]
fn a_steady_part_of_a_free_motion_has_the_true_spectrum() {
    let relief = Departures::default();
    let tool = relief.with_frequency_speed(0.0).with_level_speed(0.43);
    let odd = relief.with_level_force(-0.3).with_frequency_speed(0.6);
    for (surface, speed, force, departures) in [
        (Surface::Sandpaper, 50.0, 0.3, relief),
        (Surface::FineFabric, 150.0, 1.0, relief),
        (Surface::CoarseFabric, 80.0, 3.0, relief),
        (Surface::CorrugatedPaper, 200.0, 0.5, relief),
        (Surface::Vinyl, 100.0, 0.2, relief),
        (Surface::CorrugatedPaper, 200.0, 0.5, tool),
        (Surface::Sandpaper, 40.0, 2.0, odd),
    ] {
        let steady = FreeMotion::default().with_speed_mm_s([speed; 2]).with_force_n([force; 2]);
        let options = SimulationOptions::new(surface)
            .with_free_motion(steady)
            .with_departures(departures)
            .with_duration_s(60.0);
        let recording = simulate(&options).unwrap().to_recording("steady").unwrap();
        let target = Exploration { speed_mm_s: Some(speed), force_n: Some(force) };
        let take = Take { recording, given: target };
        let windows = SpectrumOptions::default().with_segments(SegmentChoice::Windows);
        let part = segment_take(&take, &windows, false).unwrap().spectra;
        let measured = TextureSpectrum::average(&[part], Averaging::Rms).unwrap();
        let truth = options.truth().unwrap().magnitude(speed, force).unwrap();
        let error_db =
            third_octave_error_rms_db(&measured.frequency_hz, &truth, &measured.magnitude).unwrap();
        println!("{surface}: {error_db:.2} dB from {} segments", measured.segments);
        assert!(error_db < 0.5, "{surface}: {error_db} dB");
    }
}

/// The numbers come from a NumPy program that evaluates the same physics on a grid of frequencies:
/// phases that walk randomly as Lorentzians, one-pole filters, the contact's Gaussian, the bilinear
/// skin and rig, and the Hann window's power transfer.
#[test]
fn the_truth_agrees_with_an_independent_computation() {
    let bins = [0, 4, 16, 46, 96, 196];
    let cases = [
        (
            Surface::Sandpaper,
            50.0,
            0.3,
            [0.00187364, 0.00241594, 0.00274067, 0.00185496, 0.000588759, 1.20927e-05],
        ),
        (
            Surface::FineFabric,
            150.0,
            1.0,
            [0.000376125, 0.000478198, 0.000879679, 0.00181416, 0.00243568, 0.000301616],
        ),
        (
            Surface::CoarseFabric,
            80.0,
            3.0,
            [0.00885176, 0.0204542, 0.0123337, 0.00276804, 0.000822807, 3.32169e-05],
        ),
        (
            Surface::CorrugatedPaper,
            200.0,
            0.5,
            [0.00126689, 0.00167109, 0.0267018, 0.00198381, 0.00104982, 8.79284e-05],
        ),
        (
            Surface::Vinyl,
            100.0,
            0.2,
            [0.000975731, 0.00116688, 0.000728564, 0.000218927, 7.87374e-05, 1.15338e-05],
        ),
    ];
    for (surface, speed, force, expected) in cases {
        let truth = free(surface).truth().unwrap().magnitude(speed, force).unwrap();
        for (bin, expected) in bins.into_iter().zip(expected) {
            let ratio = truth[bin] / expected;
            assert!((ratio - 1.0).abs() < 2e-3, "{surface}, bin {bin}: {ratio}");
        }
    }
}

/// A written truth, evaluated by its own rule, is also correct between its speeds.
#[test]
fn a_written_truth_states_any_speed_and_force() {
    let truth = free(Surface::CoarseFabric).truth().unwrap();
    let mut bytes = Vec::new();
    truth.write_json(&mut bytes).unwrap();
    let read: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    let list = |value: &serde_json::Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let (speeds, noise) = (list(&read["speed_mm_s"]), read["noise"].as_f64().unwrap());
    assert_eq!(list(&read["frequency_hz"]), truth.frequency_hz());
    for (speed, force) in [(36.0f64, 0.15), (71.3, 1.1), (279.0, 3.8)] {
        let above = speeds.partition_point(|v| *v < speed).clamp(1, speeds.len() - 1);
        let part = (speed / speeds[above - 1]).ln() / (speeds[above] / speeds[above - 1]).ln();
        let [below, above] = [above - 1, above].map(|row| list(&read["per_newton"][row]));
        let expected = truth.magnitude(speed, force).unwrap();
        for ((a, b), expected) in below.iter().zip(&above).zip(expected) {
            let one = (1.0 - part) * a + part * b;
            let got = (force * one).hypot(noise);
            assert!((got / expected - 1.0).abs() < 0.03, "{got} {expected}");
        }
    }
    let sweeps = SimulationOptions::new(Surface::Vinyl);
    assert!(sweeps.truth().is_err() && truth.magnitude(f64::NAN, 1.0).is_err());
    let bent = Departures::default().with_level_force(0.5);
    let mut bytes = Vec::new();
    let options = free(Surface::CoarseFabric).with_departures(bent);
    options.truth().unwrap().write_json(&mut bytes).unwrap();
    assert!(String::from_utf8(bytes).unwrap().contains("force_n^0.5 * per_newton"));
}
