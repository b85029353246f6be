//! Poles and zeros at the limits of what their line representation can express.

use std::f64::consts::PI;

use htex_dsp::line_spectrum::{coefficients_of_lines, line_spectral_frequencies};
use htex_dsp::linear_prediction::is_stable;
use htex_host::{Band, Stream};

use crate::seen::{fit_with, model, outcome_text, spectrum};
use crate::signals::{RATE_HZ, friction, noise, tone};
use crate::{Bound, Case, Section, failures, none, refused, within};

pub(crate) const SECTION: Section = Section {
    title: "ARMA",
    about: "Zeros on the unit circle and outside it, poles next to it, no poles or zeros, and orders that differ.",
    cases: CASES,
};

const BAND: Band = Band::TACTILE;

/// A parameter set at 2 kHz.
fn set(poles: &[f64], zeros: &[f64]) -> Vec<f64> {
    let counts = [poles, zeros].map(|lines| [lines.len() as f64]);
    [&counts[0], poles, &counts[1], zeros, &[2_000.0]].concat()
}

/// Whether a set has finite magnitudes and plays.
fn is_played(parameters: &[f64]) -> bool {
    let arma = model("arma");
    let magnitude = arma.magnitude(parameters, BAND, &BAND.grid_hz());
    let played = Stream::new(&arma, parameters, BAND, RATE_HZ, 1)
        .and_then(|mut stream| stream.render(&mut [0.0; 4_000]));
    magnitude.is_ok() && played.is_ok()
}

/// How a set is refused, by magnitude and by voice.
fn said_of(parameters: &[f64]) -> String {
    let arma = model("arma");
    let magnitude = outcome_text(arma.magnitude(parameters, BAND, &[100.0]));
    let voice = outcome_text(arma.voice(parameters, BAND, 2_000.0, 1));
    if magnitude == voice { voice } else { format!("by magnitude {magnitude}; by voice {voice}") }
}

/// The lines of a pair of poles, or of zeros, at a radius.
fn pair(radius: f64, hz: f64) -> Vec<f64> {
    let angle = 2.0 * PI * hz / 2_000.0;
    line_spectral_frequencies(&[2.0 * radius * angle.cos(), -radius * radius]).unwrap()
}

/// How many decibels the magnitude at a frequency, with zeros on the circle, is above its
/// neighbours.
fn notch_db(hz: f64) -> f64 {
    let line = 2.0 * PI * hz / 2_000.0;
    let parameters = set(&[], &[line, line]);
    let magnitude = model("arma").magnitude(&parameters, BAND, &[hz, hz + 50.0]).unwrap();
    20.0 * (magnitude[0] / magnitude[1]).max(1e-9).log10()
}

/// Whether mixes of sets of all orders are stable.
fn mixes() -> Vec<bool> {
    let arma = model("arma");
    let orders = [0usize, 1, 2, 5, 20, 64];
    let lines = |order: usize, bend: f64| -> Vec<f64> {
        let place = |i: usize| (i as f64 + 1.0) / (order as f64 + 1.0);
        (0..order).map(|i| PI * place(i).powf(bend)).collect()
    };
    let sets: Vec<Vec<f64>> =
        orders.iter().map(|order| set(&lines(*order, 1.3), &lines(64 - order, 0.8))).collect();
    let pairs = sets.iter().flat_map(|a| sets.iter().map(move |b| (a, b)));
    pairs
        .map(|(a, b)| {
            let mixed = arma.interpolate(&[a, b], &[0.3, 0.7]).unwrap();
            let count = mixed[0] as usize;
            let mut coefficients = vec![0.0; count];
            coefficients_of_lines(&mixed[1..=count], &mut coefficients) && is_stable(&coefficients)
        })
        .collect()
}

const CASES: &[Case] = &[
    within(
        "no poles and no zeros; poles alone; zeros alone",
        "ARMA",
        "magnitude, render",
        none("are played"),
        || {
            let sets = [set(&[], &[]), set(&pair(0.9, 200.0), &[]), set(&[], &pair(0.9, 200.0))];
            failures(sets.map(|set| is_played(&set)))
        },
    ),
    within(
        "zeros on the circle: two equal lines, a line at 0 or pi",
        "ARMA",
        "magnitude, render",
        none("are played"),
        || {
            let sets = [
                set(&[], &[1.0, 1.0]),
                set(&pair(0.9, 200.0), &[0.0]),
                set(&[], &[0.0, PI]),
                set(&[], &[f64::from(std::f32::consts::PI)]),
            ];
            failures(sets.map(|set| is_played(&set)))
        },
    ),
    within(
        "zeros on the circle at 100, 250 and 500 Hz",
        "ARMA",
        "magnitude there",
        Bound(-100.0, "dB", "that 50 Hz beside it"),
        || [100.0, 250.0, 500.0].map(notch_db).into_iter().fold(f64::NEG_INFINITY, f64::max),
    ),
    within(
        "poles at radius 1 - 1e-9 on and between bins",
        "ARMA",
        "magnitude, render",
        none("are played"),
        || {
            let radius = 1.0 - 1e-9;
            let sets = [500.0, 502.5, 20.0, 999.0].map(|hz| set(&pair(radius, hz), &[]));
            failures(sets.map(|set| is_played(&set)))
        },
    ),
    within(
        "0, 1, 2, 5, 20 and 64 poles and 64 less as many zeros",
        "ARMA",
        "mix of each two",
        none("stable"),
        || failures(mixes()),
    ),
    within(
        "noise, friction and a tone of 300 Hz, up to 64 poles and zeros",
        "ARMA",
        "fit and render",
        none("are played or refused"),
        || {
            let recordings = [noise(), friction(), tone(300.0)];
            let spectra = recordings.map(|signal| spectrum(&signal));
            let orders = [("0", "0"), ("0", "6"), ("6", "0"), ("20", "18"), ("64", "64")];
            failures(spectra.iter().flat_map(|magnitude| {
                orders.map(|(poles, zeros)| {
                    let options = [("poles", poles), ("zeros", zeros)];
                    let fitted = fit_with(&model("arma"), magnitude, &[], &options);
                    fitted.is_err() || fitted.is_ok_and(|fit| is_played(&fit.parameters))
                })
            }))
        },
    ),
    refused(
        "lines of poles that are equal",
        "ARMA",
        "magnitude and voice",
        "do not ascend",
        || said_of(&set(&[1.0, 1.0], &[])),
    ),
    refused("a line of poles at 0", "ARMA", "magnitude and voice", "do not ascend", || {
        said_of(&set(&[0.0, 1.0], &[]))
    }),
    refused("lines of zeros that descend", "ARMA", "magnitude and voice", "descend", || {
        said_of(&set(&[], &[1.0, 0.5]))
    }),
    refused("filters of 2 kHz and 1 kHz", "ARMA", "mix", "different model rates", || {
        let (a, mut b) = (set(&[1.0], &[]), set(&[1.0], &[]));
        b[3] = 1_000.0;
        outcome_text(model("arma").interpolate(&[&a, &b], &[0.5, 0.5]))
    }),
    refused(
        "a zero on the circle, and a filter of more zeros",
        "ARMA",
        "mix",
        "another order",
        || {
            let (a, b) = (set(&[], &[1.0, 1.0]), set(&[], &[0.5, 1.0, 1.5]));
            outcome_text(model("arma").interpolate(&[&a, &b], &[0.5, 0.5]))
        },
    ),
];
