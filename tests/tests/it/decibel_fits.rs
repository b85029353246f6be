//! Fits of AR and MFCC in decibels, on white noise and on slopes, where their other fits and
//! inverses have an error that is the same for every recording.

use crate::common;
use htex_dsp::fidelity::third_octave_error_rms_db;
use htex_dsp::grid::level_rms;
use htex_dsp::linear_prediction::{is_stable, scale_poles};
use htex_host::{Band, Fit, Registry};

const BAND: Band = Band::TACTILE;
const NEAREST: &[(&str, &str)] = &[("inverse", "log-log"), ("fit", "decibel")];

fn fit(model: &str, magnitude: &[f64], options: &[(&str, &str)]) -> Fit {
    let model = Registry::builtin().find(model).unwrap().clone();
    common::fit(&model, BAND, magnitude, (20_000.0, options))
}

/// Third-octave error of a fit at the level of its spectrum, dB.
fn error_db(model: &str, magnitude: &[f64], options: &[(&str, &str)]) -> f64 {
    let fit = fit(model, magnitude, options);
    let (grid, level) = (BAND.grid_hz(), level_rms(magnitude));
    let model = Registry::builtin().find(model).unwrap().clone();
    let shape = model.magnitude(&fit.parameters, BAND, &grid).unwrap();
    let fitted: Vec<f64> = shape.iter().map(|m| m * level).collect();
    third_octave_error_rms_db(&grid, magnitude, &fitted).unwrap()
}

/// Magnitudes of noise whose power is this power of the frequency: 0 is white, and -4 falls by
/// 12 dB per octave.
fn slope(exponent: f64) -> Vec<f64> {
    BAND.grid_hz().iter().map(|f| 0.1 * f.powf(0.5 * exponent)).collect()
}

#[test]
fn decibels_remove_the_error_at_the_edges_and_on_slopes() {
    // The exponent; at most this error of a fit in decibels, and at least this error of the default.
    for (exponent, mfcc, mfcc_default, ar, ar_default) in [
        (0.0, 0.05, 2.0, 0.01, 0.5),
        (-1.0, 0.3, 2.8, 0.35, 0.9),
        (-2.0, 0.6, 3.7, 0.05, 1.6),
        (-4.0, 1.3, 7.3, 0.1, 1.9),
    ] {
        let spectrum = slope(exponent);
        let [pinv, nnls, interpolated, log_log] = ["pinv", "nnls", "interpolate", "log-log"]
            .map(|inverse| error_db("mfcc", &spectrum, &[("inverse", inverse)]));
        let nearest = error_db("mfcc", &spectrum, NEAREST);
        let [yule_walker, decibel] =
            ["yule-walker", "decibel"].map(|m| error_db("ar", &spectrum, &[("method", m)]));
        println!(
            "f^{exponent}: MFCC pinv {pinv:.2}, nnls {nnls:.2}, interpolate {interpolated:.2}, \
             log-log {log_log:.2}, in decibels {nearest:.2}; AR Yule-Walker {yule_walker:.2}, \
             in decibels {decibel:.3} dB"
        );
        assert!(nearest < mfcc && pinv > mfcc_default, "MFCC {nearest}, {pinv}");
        assert!(decibel < ar && yule_walker > ar_default, "AR {decibel}, {yule_walker}");
        assert!(log_log < 0.6 * pinv && nearest < 0.7 * log_log, "{log_log}");
    }
}

/// The level that a fit implies is the spectrum's, so `--level fitted` plays it as strong.
#[test]
fn a_fit_in_decibels_has_the_level_of_its_spectrum() {
    let spectrum = slope(-3.0);
    let way: &[(&str, &str)] = &[("method", "decibel")];
    for (model, options) in [("mfcc", NEAREST), ("ar", way)] {
        let ratio = fit(model, &spectrum, options).level_rms / level_rms(&spectrum);
        assert!((ratio - 1.0).abs() < 1e-9, "{model}: {ratio}");
    }
}

/// On lines and on silence beside them, fits of orders up to 64 are stable, and fits of the default
/// order keep every pole 5 Hz wide. (Rounding moves the poles of high orders, which lie close
/// together.)
#[test]
fn fits_to_lines_are_stable_and_no_narrower_than_a_bin() {
    let line = |at: usize| (0..BAND.bins()).map(|i| f64::from(u8::from(i == at))).collect();
    let half = (0..BAND.bins()).map(|i| if i < 98 { 1.0 } else { 0.0 }).collect();
    let spectra: [Vec<f64>; 5] = [line(0), line(96), line(196), half, slope(-4.0)];
    let radius = (-std::f64::consts::PI * 5.0 / 2_000.0).exp();
    for order in ["1", "6", "13", "64"] {
        for spectrum in &spectra {
            let fitted = fit("ar", spectrum, &[("method", "decibel"), ("order", order)]);
            let count = fitted.parameters[0] as usize;
            let coefficients = &fitted.parameters[1..=count];
            assert!(is_stable(coefficients), "order {order}");
            let widened = scale_poles(coefficients, (1.0 - 1e-6) / radius);
            assert!(count > 6 || is_stable(&widened), "order {order}");
        }
    }
}
