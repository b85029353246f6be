//! The beta density and sBeta at the limits of their parameters.

use htex_dsp::beta::BetaDensity;
use htex_dsp::grid::level_rms;
use htex_host::{Band, Fit};

use crate::big::{Big, big};
use crate::seen::{fit_with, model, outcome_text, spectrum};
use crate::signals::tone;
use crate::{Bound, Case, Section, failures, none, refused, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "Beta density",
    about: "The density against 256 bits (ln Γ by Stirling's series), and sBeta with few, equal and extreme peaks: fitted to \
            peaks and bins in decibels, and to peaks alone by magnitudes.",
    cases: CASES,
};

const BAND: Band = Band::TACTILE;
const PLACES: [f64; 9] = [1e-12, 1e-3, 0.1, 0.3, 0.5, 0.7, 0.9, 0.999, 1.0 - 1e-12];

/// ln Γ(x) in 256 bits: shifted above 60, then Stirling's series with 12 terms, accurate to 1e-33.
fn log_gamma(x: f64) -> Big {
    // B_2n / (2n (2n - 1)).
    const TERMS: [(f64, f64); 12] = [
        (1.0, 12.0),
        (-1.0, 360.0),
        (1.0, 1260.0),
        (-1.0, 1680.0),
        (1.0, 1188.0),
        (-691.0, 360_360.0),
        (1.0, 156.0),
        (-3617.0, 122_400.0),
        (43_867.0, 244_188.0),
        (-174_611.0, 125_400.0),
        (77_683.0, 5796.0),
        (-236_364_091.0, 1_506_960.0),
    ];
    let (mut x, mut product) = (big(x), big(1.0));
    while x.to_f64() < 60.0 {
        product = product * x.clone();
        x = x + big(1.0);
    }
    let half = big(0.5);
    let leading = (x.clone() - half.clone()) * x.ln() - x.clone();
    let mut sum = leading + half * (big(2.0) * Big::pi()).ln() - product.ln();
    let mut power = x.clone();
    for (over, under) in TERMS {
        sum = sum + big(over) / big(under) / power.clone();
        power = power * x.clone() * x.clone();
    }
    sum
}

/// ln B(α, β).
fn log_beta(alpha: f64, beta: f64) -> Big {
    log_gamma(alpha) + log_gamma(beta) - log_gamma(alpha + beta)
}

fn log_density(u: f64, alpha: f64, beta: f64, log_beta: &Big) -> Big {
    let (a, b) = (big(alpha) - big(1.0), big(beta) - big(1.0));
    a * big(u).ln() + b * (big(1.0) - big(u)).ln() - log_beta.clone()
}

/// Largest relative error of the density where it does not underflow.
fn density_error(parameters: &[f64], places: &[f64]) -> f64 {
    let mut worst = 0.0;
    for &alpha in parameters {
        for &beta in parameters {
            let scale = log_beta(alpha, beta);
            let density = BetaDensity::new(alpha, beta);
            for &u in places {
                let log = log_density(u, alpha, beta, &scale);
                let found = density.density_at(u);
                let error = match log.to_f64() {
                    // A value that rounds to zero must be close to zero.
                    small if small < -700.0 => (found >= 1e-300).into(),
                    _ => log.exp().relative_error(found),
                };
                worst = worse(worst, if error == 1.0 { f64::NAN } else { error });
            }
        }
    }
    worst
}

/// Whether shapes have unit RMS and their voices are close to it. A refusal counts if it is
/// `allowed`.
fn shapes(parameters: &[f64], allowed: bool) -> f64 {
    let each = |alpha| parameters.iter().map(move |&beta| [alpha, beta]);
    let sets = parameters.iter().flat_map(|&alpha| each(alpha));
    failures(sets.map(|set| {
        let said = shape(&set);
        if said != "unit RMS" {
            println!("{set:?}: {said}");
        }
        said == "unit RMS" || allowed && said.contains("put all energy between two bins")
    }))
}

/// What happens to a parameter set, by magnitude and by voice.
fn shape(set: &[f64]) -> String {
    let sbeta = model("sbeta");
    let magnitude = sbeta.magnitude(set, BAND, &BAND.grid_hz());
    let voice = sbeta.voice(set, BAND, 2_500.0, 1);
    let (magnitude, mut voice) = match (magnitude, voice) {
        (Ok(magnitude), Ok(voice)) => (magnitude, voice),
        (Err(one), Err(other)) if one.to_string() != other.to_string() => {
            let same =
                |e: &htex_host::HostError| e.to_string().split(": ").last().map(String::from);
            return if same(&one) == same(&other) {
                one.to_string()
            } else {
                format!("{one}; {other}")
            };
        }
        (one, other) => return format!("{one:?}; {other:?}"),
    };
    let mut out = vec![0.0f32; 25_000];
    if let Err(error) = voice.render(&mut out) {
        return error.to_string();
    }
    let power: f64 = out.iter().map(|&x| f64::from(x).powi(2)).sum();
    let rms = (power / out.len() as f64).sqrt();
    if (level_rms(&magnitude) - 1.0).abs() < 1e-9 && (0.5..2.0).contains(&rms) {
        "unit RMS".to_owned()
    } else {
        format!("RMS {rms}")
    }
}

/// A spectrum with 1 N peaks at some bins, on a floor.
fn peaks(at: &[usize], floor: f64) -> Vec<f64> {
    let mut magnitude = vec![floor; BAND.bins()];
    at.iter().for_each(|&bin| magnitude[bin] = 1.0);
    magnitude
}

/// Fits to peaks and bins in decibels, which is the default, and fits only to peaks by magnitudes.
const WAYS: [[(&str, &str); 2]; 2] =
    [[("error", "decibel"), ("bins", "20")], [("error", "magnitude"), ("bins", "0")]];

/// Whether spectra can be fitted in both ways with each lower bound, and play.
fn fitted(spectra: &[Vec<f64>]) -> f64 {
    let sbeta = model("sbeta");
    let bounds = || WAYS.into_iter().flat_map(|way| ["1", "0", "0.5"].map(|bound| (way, bound)));
    failures(spectra.iter().flat_map(|magnitude| {
        bounds().map(|(way, bound)| {
            let options = [&way[..], &[("lower_bound", bound)]].concat();
            fit_with(&sbeta, magnitude, &[], &options).is_ok_and(|fit| {
                let [alpha, beta] = [fit.parameters[0], fit.parameters[1]];
                let least = bound.parse::<f64>().unwrap().max(1e-3);
                let inside = |x: f64| (least..=1e4).contains(&x);
                let shape = sbeta.magnitude(&fit.parameters, BAND, &BAND.grid_hz());
                inside(alpha)
                    && inside(beta)
                    && fit.level_rms > 0.1 * level_rms(magnitude)
                    && shape.is_ok()
            })
        })
    }))
}

/// The worst value of a measure over fits of tones at 150, 500 and 747.5 Hz, in both ways, with
/// lower bounds 0.5 and 1.
fn of_tones(off: impl Fn(f64, &Fit) -> f64) -> f64 {
    let (sbeta, mut worst) = (model("sbeta"), 0.0);
    for hz in [150.0, 500.0, 747.5] {
        let magnitude = spectrum(&tone(hz));
        for (way, bound) in WAYS.iter().flat_map(|way| ["0.5", "1"].map(|bound| (way, bound))) {
            let options = [&way[..], &[("lower_bound", bound)]].concat();
            let fitted = fit_with(&sbeta, &magnitude, &[], &options);
            worst = worse(worst, fitted.map_or(f64::NAN, |fit| off(hz, &fit)));
        }
    }
    worst
}

const CASES: &[Case] = &[
    within(
        "alpha and beta of 0.001, 0.5, 1, 1 + 1e-9, 2, 7.5, 99",
        "density",
        "evaluate, down to 1e-12 from the edges",
        Bound(2e-13, "of it", "256 bits"),
        || density_error(&[1e-3, 0.5, 1.0, 1.0 + 1e-9, 2.0, 7.5, 99.0], &PLACES),
    ),
    within(
        "alpha and beta of 1e4, 1e6",
        "density",
        "evaluate near the mode",
        Bound(1e-8, "of it", "256 bits"),
        || {
            let near = [0.009, 0.01, 0.49, 0.4999, 0.5, 0.5003, 0.51, 0.99, 0.9901];
            density_error(&[1e4, 1e6], &near)
        },
    ),
    within(
        "the edges 0 and 1, alpha and beta below, at and above 1",
        "density",
        "evaluate",
        none("the limit: infinite, finite, 0"),
        || {
            failures([
                BetaDensity::new(0.5, 2.0).density_at(0.0) == f64::INFINITY,
                BetaDensity::new(2.0, 0.5).density_at(1.0) == f64::INFINITY,
                (BetaDensity::new(1.0, 3.0).density_at(0.0) - 3.0).abs() < 1e-12,
                (BetaDensity::new(3.0, 1.0).density_at(1.0) - 3.0).abs() < 1e-12,
                BetaDensity::new(2.0, 0.5).density_at(0.0) == 0.0,
                BetaDensity::new(1e6, 1e6).density_at(1.0) == 0.0,
                BetaDensity::new(0.5, 0.5).density_at(-0.1) == 0.0,
                BetaDensity::new(0.5, 0.5).density_at(1.1) == 0.0,
            ])
        },
    ),
    within(
        "alpha or beta 0, negative, infinite or NaN; NaN as place",
        "density",
        "evaluate",
        none("NaN"),
        || {
            let bad = [0.0, -1.0, f64::INFINITY, f64::NAN];
            let density = bad.map(|p| {
                BetaDensity::new(p, 1.0).density_at(0.5).is_nan()
                    && BetaDensity::new(1.0, p).density_at(0.5).is_nan()
            });
            failures(
                density
                    .into_iter()
                    .chain([BetaDensity::new(2.0, 2.0).density_at(f64::NAN).is_nan()]),
            )
        },
    ),
    within(
        "alpha and beta of 0.001, 0.5, 1, 1 + 1e-9, 2, 100, each with each",
        "sBeta",
        "magnitude, render",
        none("unit RMS"),
        || shapes(&[1e-3, 0.5, 1.0, 1.0 + 1e-9, 2.0, 100.0], false),
    ),
    within(
        "alpha and beta of 0.5, 1 + 1e-9, 1e4, 1e6, each with each",
        "sBeta",
        "magnitude, render",
        none("unit RMS, or refused: all energy between two bins"),
        || shapes(&[0.5, 1.0 + 1e-9, 1e4, 1e6], true),
    ),
    refused(
        "alpha 31,030 and beta 1e6: 0.6 Hz wide at 22.5 Hz",
        "sBeta",
        "magnitude, voice",
        "put all energy between two bins of the 5 Hz grid",
        || {
            let (sbeta, set) = (model("sbeta"), [31_030.0, 1e6]);
            let magnitude = outcome_text(sbeta.magnitude(&set, BAND, &[100.0]));
            let voice = outcome_text(sbeta.voice(&set, BAND, 2_500.0, 1));
            if magnitude == voice { voice } else { format!("{magnitude}; {voice}") }
        },
    ),
    within(
        "one peak, in the middle, next to an edge, on an edge",
        "sBeta",
        "fit in both ways, lower bounds 0, 0.5, 1",
        none("in range, played, and within 20 dB of its level"),
        || {
            fitted(&[
                peaks(&[50], 0.0),
                peaks(&[1], 0.0),
                peaks(&[195], 0.0),
                peaks(&[0], 0.0),
                peaks(&[196], 1e-9),
            ])
        },
    ),
    within(
        "a tone of 1 N at 150, 500, 747.5 Hz",
        "sBeta",
        "level of the fit, in both ways",
        Bound(12.1, "dB", "the tone's"),
        || of_tones(|_, fit| 20.0 * (fit.level_rms * 2f64.sqrt()).log10().abs()),
    ),
    within(
        "a tone of 1 N at 150, 500, 747.5 Hz",
        "sBeta",
        "the highest bin of the fit, in both ways",
        Bound(1.0, "octave", "the tone"),
        || {
            of_tones(|hz, fit| {
                let shape = model("sbeta")
                    .magnitude(&fit.parameters, BAND, &BAND.grid_hz())
                    .unwrap_or_default();
                let highest = (0..shape.len()).max_by(|&a, &b| shape[a].total_cmp(&shape[b]));
                highest.map_or(f64::NAN, |bin| (BAND.grid_hz()[bin] / hz).log2().abs())
            })
        },
    ),
    within(
        "two peaks: far apart, nearer than can be told apart, side by side",
        "sBeta",
        "fit in both ways, lower bounds 0, 0.5, 1",
        none("in range, played, and within 20 dB of its level"),
        || fitted(&[peaks(&[2, 190], 0.0), peaks(&[100, 104], 0.1), peaks(&[100, 101], 0.0)]),
    ),
    within(
        "ten equal peaks; a flat spectrum; a plateau",
        "sBeta",
        "fit in both ways, lower bounds 0, 0.5, 1",
        none("in range, played, and within 20 dB of its level"),
        || {
            let ten: Vec<usize> = (0..10).map(|i| 10 + 18 * i).collect();
            let plateau: Vec<usize> = (60..140).collect();
            fitted(&[peaks(&ten, 0.0), peaks(&ten, 0.5), peaks(&[], 1.0), peaks(&plateau, 0.2)])
        },
    ),
    within(
        "a spectrum that rises to both edges",
        "sBeta",
        "fit in both ways, lower bounds 0, 0.5, 1",
        none("in range, played, and within 20 dB of its level"),
        || {
            let valley = |i: usize| (i as f64 - 98.0).powi(4) / 1e8 + 0.01 * (i % 2) as f64;
            fitted(&[(0..BAND.bins()).map(valley).collect()])
        },
    ),
];
