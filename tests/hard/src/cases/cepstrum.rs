//! Mel banks finer than the grid, and cepstra of empty spectra.

use htex_dsp::dct::{InverseDct, dct_ii};
use htex_dsp::grid::level_rms;
use htex_dsp::least_squares::PseudoInverse;
use htex_dsp::mel::{MelBank, hz_to_mel, mel_to_hz};
use htex_dsp::non_negative::{NonNegative, Scratch};
use htex_host::{Band, FitCondition, FitInput};

use crate::big::{Big, big};
use crate::seen::{fit_with, model, outcome_text, spectrum};
use crate::signals::{far_apart, friction, tone};
use crate::{Bound, Case, Section, failures, none, refused, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "Cepstra",
    about: "Mel banks, cosine transforms, least squares, and MFCC with them.",
    cases: CASES,
};

const BAND: Band = Band::TACTILE;
/// The band of a 200 Hz recording: 17 bins.
const NARROW: Band = Band { low_hz: 20.0, high_hz: 100.0 };
/// Every inverse, and every way to fit.
const WAYS: [[&str; 2]; 6] = [
    ["pinv", "transform"],
    ["nnls", "transform"],
    ["interpolate", "transform"],
    ["log-log", "transform"],
    ["pinv", "decibel"],
    ["log-log", "decibel"],
];

/// Whether a spectrum is fitted with these bands and coefficients, by every inverse and way to fit, at unit RMS,
/// and with a level within 20 dB of its own.
fn lives(magnitude: &[f64], bands: &str, coefficients: &str) -> f64 {
    let mfcc = model("mfcc");
    failures(WAYS.map(|[inverse, fit]| {
        let size = [("bands", bands), ("coefficients", coefficients)];
        let options = [size[0], size[1], ("inverse", inverse), ("fit", fit)];
        let Ok(fitted) = fit_with(&mfcc, magnitude, &[], &options) else {
            return false;
        };
        let shape = mfcc.magnitude(&fitted.parameters, BAND, &BAND.grid_hz());
        let played = mfcc
            .voice(&fitted.parameters, BAND, 2_500.0, 1)
            .and_then(|mut voice| voice.render(&mut [0.0; 1_000]));
        let off_db = 20.0 * (fitted.level_rms / level_rms(magnitude)).log10();
        let holds = shape.is_ok_and(|m| (level_rms(&m) - 1.0).abs() < 1e-9)
            && played.is_ok()
            && off_db.abs() < 20.0;
        if !holds {
            println!("{bands} bands, {coefficients} coefficients, {inverse}, {fit}: {off_db} dB");
        }
        holds
    }))
}

/// Failures of fits, by every inverse and way to fit, in a band in which most filters are empty.
fn empty_bands(bands: &str) -> f64 {
    let (mfcc, grid) = (model("mfcc"), NARROW.grid_hz());
    let magnitude: Vec<f64> = grid.iter().map(|f| 1.0 / f).collect();
    failures(WAYS.map(|[inverse, fit]| {
        let size = [("bands", bands), ("coefficients", bands)];
        let options = [size[0], size[1], ("inverse", inverse), ("fit", fit)];
        let fitted = mfcc.fit(&FitInput {
            band: NARROW,
            frequency_hz: &grid,
            magnitude: &magnitude,
            signal: &[],
            signal_rate_hz: 200.0,
            options: &mfcc.options(&options).unwrap(),
            condition: FitCondition::default(),
        });
        fitted.is_ok_and(|fit| {
            let shape = mfcc.magnitude(&fit.parameters, NARROW, &grid);
            let played = mfcc
                .voice(&fit.parameters, NARROW, 250.0, 1)
                .and_then(|mut voice| voice.render(&mut [0.0; 1_000]));
            shape.is_ok_and(|m| (level_rms(&m) - 1.0).abs() < 1e-9) && played.is_ok()
        })
    }))
}

/// A cepstrum as a parameter set.
fn set(cepstrum: &[f64], bands: f64, inverse: f64) -> Vec<f64> {
    let count = [cepstrum.len() as f64];
    [&count[..], cepstrum, &[bands, inverse]].concat()
}

/// Error of the orthonormal DCT-II for numbers up to 1, compared with 256 bits.
fn dct_error(n: usize) -> f64 {
    let values: Vec<f64> = (0..n).map(|i| ((7 * i + 3) % 11) as f64 / 11.0).collect();
    let mut found = vec![0.0; n + 2];
    dct_ii(&values, &mut found);
    let reference = |k: usize| {
        let sum = values.iter().enumerate().fold(big(0.0), |sum, (i, &x)| {
            let turn = big((k * (2 * i + 1)) as f64) / big(2.0 * n as f64);
            sum + big(x) * (Big::pi() * turn).cos()
        });
        sum * (big(if k == 0 { 1.0 } else { 2.0 }) / big(n as f64)).sqrt()
    };
    let off = (0..n).map(|k| (big(found[k]) - reference(k)).to_f64().abs());
    let beyond = found[n].abs() + found[n + 1].abs();
    let mut back = vec![0.0; n];
    InverseDct::new(n).run(&found, &mut back);
    let there_and_back = back.iter().zip(&values).map(|(a, b)| (a - b).abs());
    off.chain(there_and_back).fold(beyond, worse)
}

/// Error of the least-squares solution of a system whose columns nearly coincide.
fn pseudo_inverse_error() -> f64 {
    // 1/3 of a degree apart; x = (1, 1).
    let (cos, sin) = (0.005f64.cos(), 0.005f64.sin());
    let matrix = [1.0, cos, 0.0, sin, 0.0, 0.0];
    let mut x = [0.0; 2];
    PseudoInverse::new(&matrix, 3, 2).apply(&[1.0 + cos, sin, 5.0], &mut x);
    x.iter().map(|x| (x - 1.0).abs()).fold(0.0, worse)
}

const CASES: &[Case] = &[
    within(
        "0 to 1 MHz",
        "mel scale",
        "to mel and back",
        Bound(1e-12, "of it, or Hz", "256 bits and the frequency"),
        || {
            let off = [0.0, 1e-9, 20.0, 999.9, 1e6].map(|hz: f64| {
                let ratio = big(1.0) + big(hz) / big(700.0);
                let mel = big(2595.0) * ratio.ln() / big(10.0).ln();
                let scale = hz.max(1.0);
                let there = (big(hz_to_mel(hz)) - mel).to_f64().abs() / scale;
                worse(there, (mel_to_hz(hz_to_mel(hz)) - hz).abs() / scale)
            });
            off.into_iter().fold(0.0, worse)
        },
    ),
    within(
        "1, 2, 26, 64 values",
        "cosine transform",
        "there and back, more coefficients than values",
        Bound(1e-14, "× the values", "256 bits, and 0 beyond them,"),
        || [1, 2, 26, 64].map(dct_error).into_iter().fold(0.0, worse),
    ),
    within(
        "columns 0.3° apart",
        "pseudo-inverse",
        "solve",
        Bound(1e-11, "of it", "the solution"),
        pseudo_inverse_error,
    ),
    within(
        "all zero, NaN, infinite, empty; columns the same",
        "pseudo-inverse",
        "solve",
        none("solved, without more dependent columns than the rank"),
        || {
            let rank = |m: &[f64], rows, columns| PseudoInverse::new(m, rows, columns).rank();
            failures([
                rank(&[0.0; 4], 2, 2) == 0,
                rank(&[], 0, 0) == 0,
                rank(&[1.0, 1.0, 2.0, 2.0, 3.0, 3.0], 3, 2) == 1,
                rank(&[f64::NAN; 4], 2, 2) <= 2,
                rank(&[f64::INFINITY, 1.0, 1.0, 1.0], 2, 2) <= 2,
            ])
        },
    ),
    within(
        "26 bands, energies 600 dB apart in turns",
        "non-negative least squares",
        "solve",
        none("finite, not negative"),
        || {
            let grid = Band::TACTILE.grid_hz();
            let bank = MelBank::new(26, Band::TACTILE, &grid);
            let energies: Vec<f64> = (0..26).map(|i| 10f64.powi(60 * (i % 2))).collect();
            let mut power = [f64::NAN; 197];
            NonNegative::new(bank.filters()).solve(&energies, &mut power, &mut Scratch::new(26));
            failures(power.map(|p| p.is_finite() && p >= 0.0))
        },
    ),
    within(
        "128 bands over 17 bins: filters between two bins",
        "mel bank",
        "energies, interpolation",
        none("some are empty; energy 0 there, finite all over"),
        || {
            let grid = NARROW.grid_hz();
            let bank = MelBank::new(128, NARROW, &grid);
            let energies = bank.energies(&[1.0; 17]);
            let mut power = [f64::NAN; 17];
            bank.interpolate(&energies, &mut power);
            let empty = bank.filters().row_sums().iter().filter(|s| **s == 0.0).count();
            failures([
                empty > 0,
                energies.iter().all(|e| e.is_finite() && *e >= 0.0),
                power.iter().all(|p| p.is_finite() && *p >= 0.0),
            ])
        },
    ),
    within(
        "17 bins, 26 and 128 bands, most of them empty",
        "MFCC",
        "fit, magnitude, render, each inverse and fit, all coefficients",
        none("unit RMS"),
        || ["26", "128"].map(empty_bands).iter().sum(),
    ),
    within(
        "friction noise, 128 bands",
        "MFCC",
        "fit, magnitude, render, each inverse and fit, 1 to 128 coefficients",
        none("unit RMS, level within 20 dB"),
        || {
            let magnitude = spectrum(&friction());
            ["1", "10", "64"].map(|c| lives(&magnitude, "128", c)).iter().sum()
        },
    ),
    within(
        "friction noise, more coefficients than bands: 128 of 2, 3 and 26",
        "MFCC",
        "fit, magnitude, render, each inverse and fit",
        none("unit RMS, level within 20 dB"),
        || {
            let magnitude = spectrum(&friction());
            ["2", "3", "26"].map(|bands| lives(&magnitude, bands, "128")).iter().sum()
        },
    ),
    within(
        "bands of zero power: one bin, one half of the band, all but the bin next to the edge",
        "MFCC",
        "fit, magnitude, render, each inverse and fit",
        none("unit RMS, level within 20 dB"),
        || {
            let only = |keep: fn(usize) -> bool| -> Vec<f64> {
                (0..197).map(|i| f64::from(u8::from(keep(i)))).collect()
            };
            // Only the first filter sees the bin next to the edge.
            let spectra =
                [only(|i| i < 98), only(|i| i >= 98), only(|i| i != 50), only(|i| i == 1)];
            spectra.iter().map(|m| lives(m, "26", "26")).sum()
        },
    ),
    within(
        "a tone, tones 120 dB apart",
        "MFCC",
        "fit, magnitude, render, each inverse and fit, 26 coefficients",
        none("unit RMS, level within 20 dB"),
        || {
            let spectra = [spectrum(&tone(500.0)), spectrum(&far_apart())];
            spectra.iter().map(|m| lives(m, "26", "26")).sum()
        },
    ),
    refused(
        "a cepstrum of 1e5: energies beyond f64",
        "MFCC",
        "magnitude",
        "InvalidParameters: the cepstrum's band energies are not finite",
        || {
            let parameters = set(&[1e5], 26.0, 0.0);
            outcome_text(model("mfcc").magnitude(&parameters, BAND, &[100.0]))
        },
    ),
    refused(
        "a cepstrum of -1e5: energies of 0",
        "MFCC",
        "voice",
        "InvalidParameters: the cepstrum's band energies are not finite, or all zero",
        || {
            let parameters = set(&[-1e5], 26.0, 2.0);
            outcome_text(model("mfcc").voice(&parameters, BAND, 2_500.0, 1))
        },
    ),
];
