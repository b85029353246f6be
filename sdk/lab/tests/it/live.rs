//! Live spectrum: the height of tones and noise, compared with a transform that is written out
//! here.

use crate::recording;

use std::f64::consts::TAU;
use std::fs;

use htex_format::Quantity;
use htex_lab::record::{LiveSignal, Moment, Next, Phase};
use proptest::prelude::*;
use recording::{RATE_HZ, Settings, session, sweeps};

fn live(rate_hz: f64, axes: &[&[f64]]) -> LiveSignal {
    let mut signal = LiveSignal::new(Quantity::LateralForce, rate_hz);
    // In blocks of any length, as they come from a source.
    let length = axes[0].len();
    let mut at = 0;
    for block in [1, 37, 200, 40].into_iter().cycle() {
        let end = (at + block).min(length);
        let blocks: Vec<&[f64]> = axes.iter().map(|axis| &axis[at..end]).collect();
        signal.push(&blocks);
        at = end;
        if at == length {
            break;
        }
    }
    signal
}

/// Returns the magnitude of the last 0.4 s at a frequency (Hz): the root of the mean power of three
/// windows, summed over the axes.
fn magnitude(rate_hz: f64, axes: &[Vec<f64>], hz: f64) -> f64 {
    let len = (0.2 * rate_hz).round() as usize;
    let mut power = 0.0;
    for axis in axes {
        let last = &axis[axis.len() - 2 * len..];
        for segment in [0, len / 2, len].map(|start| &last[start..start + len]) {
            let mean = segment.iter().sum::<f64>() / len as f64;
            let (mut re, mut im) = (0.0, 0.0);
            for (i, x) in segment.iter().enumerate() {
                let window = 0.5 - 0.5 * (TAU * i as f64 / len as f64).cos();
                let angle = TAU * hz * i as f64 / rate_hz;
                re += (x - mean) * window * angle.cos();
                im -= (x - mean) * window * angle.sin();
            }
            power += (4.0 / len as f64).powi(2) * (re * re + im * im) / 3.0;
        }
    }
    power.sqrt()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// On the 5 Hz grid, a sinusoid has its amplitude within 0.01 dB. Between two grid points, the
    /// highest value is at most 1.43 dB lower, which is the loss of a Hann window there.
    #[test]
    fn a_sinusoid_has_its_height(
        bin in 6..199_u32,
        between in prop_oneof![Just(0.0), 0.0..1.0_f64],
        amplitude in 1e-4..1.0_f64,
        phase in 0.0..TAU,
        rate_hz in prop_oneof![Just(2_500.0), Just(10_000.0), Just(20_000.0)],
    ) {
        let hz = 5.0 * (f64::from(bin) + between);
        let tone = |i: usize| 0.5 + amplitude * (TAU * hz * i as f64 / rate_hz + phase).sin();
        let samples: Vec<f64> = (0..(0.5 * rate_hz) as usize).map(tone).collect();
        let spectrum = live(rate_hz, &[&samples]).spectrum().unwrap();
        prop_assert_eq!(spectrum.frequency_hz.len(), 197);
        let (at_hz, peak_db) = spectrum.peak();
        let above_db = peak_db - 20.0 * amplitude.log10();
        prop_assert!((at_hz - hz).abs() <= 2.51, "{hz} Hz is shown at {at_hz} Hz");
        let lowest = if between == 0.0 { -0.01 } else { -1.43 };
        prop_assert!((lowest..0.01).contains(&above_db), "{above_db} dB");
        // Between the centres of the first (29.6 Hz) and the last band (676 Hz), the weights of the
        // nine bands add to one, so the bands add to the square of the RMS value. The margin to
        // these centres allows for the window, which spreads a sinusoid by 10 Hz.
        if (40.0..640.0).contains(&hz) {
            let all: f64 = spectrum.band_db.iter().map(|db| 10_f64.powf(db / 10.0)).sum();
            let error_db = 10.0 * (all / (0.5 * amplitude * amplitude)).log10();
            prop_assert!(error_db.abs() < 0.02, "{error_db} dB at {hz} Hz");
        }
    }
}

#[test]
fn what_a_session_shows_is_the_transform_of_the_newest_samples_of_the_source() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.4]);
    let mut signal = LiveSignal::new(Quantity::LateralForce, RATE_HZ);
    let mut spectra = Vec::new();
    let mut watch = |moment: &Moment<'_>| {
        assert_eq!((moment.phase, moment.texture.len()), (Phase::Take, 2));
        signal.push(moment.texture);
        if (2.5..2.6).contains(&moment.elapsed_s) {
            spectra.push((moment.elapsed_s, moment.force_n, signal.spectrum().unwrap()));
        }
        Next::Go
    };
    let mut session = session(folder.path(), &source, &Settings::default(), None).unwrap();
    session.record(&mut watch, &mut |_| ()).unwrap();
    let text = fs::read_to_string(&source).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert!(spectra.len() >= 5);
    for (elapsed_s, force_n, spectrum) in spectra {
        let end = (elapsed_s * RATE_HZ).round() as usize;
        let axes = [0, 1].map(|axis| rows[..end].iter().map(|row| row[axis]).collect::<Vec<f64>>());
        for at in [0, 1, 20, 96, 150, 196] {
            let expected_db = 20.0 * magnitude(RATE_HZ, &axes, spectrum.frequency_hz[at]).log10();
            let shown_db = spectrum.level_db[at];
            assert!((shown_db - expected_db).abs() < 1e-6, "{shown_db} {expected_db} dB");
        }
        // The force is the mean of the last 50 ms.
        let last = &rows[end - 100..end];
        let mean_n = last.iter().map(|row| row[2]).sum::<f64>() / 100.0;
        assert!((force_n.unwrap() - mean_n.abs()).abs() < 1e-9);
    }
}

#[test]
fn samples_that_are_no_recording_have_no_spectrum() {
    let spectrum = |rate_hz: f64, samples: &[f64]| live(rate_hz, &[samples]).spectrum();
    assert!(spectrum(2_000.0, &[0.1; 399]).is_none(), "0.2 s are needed");
    let silent = spectrum(2_000.0, &[0.1; 400]).unwrap();
    assert_eq!((silent.level_db[7], silent.band_db[8]), (-200.0, -200.0));
    assert!(spectrum(2_000.0, &[f64::NAN; 800]).is_none());
    assert!(spectrum(30.0, &[0.1; 30]).is_none(), "below 20 Hz alone");
    let low = spectrum(1_000.0, &[0.1; 800]).unwrap();
    assert_eq!(low.frequency_hz.last(), Some(&500.0));
    assert!(LiveSignal::new(Quantity::Acceleration, 2_000.0).spectrum().is_none());
}
