//! The AR model beyond its usual order and rate.

use htex_host::{Band, FitCondition, FitInput, Stream};

use crate::seen::{fit_with, model, models, outcome_text, spectrum};
use crate::signals::{RATE_HZ, friction, noise, tone};
use crate::{Bound, Case, Section, exact, failures, none, refused, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "AR",
    about: "Parameters that a fit gives, and parameters that a file may hold.",
    cases: CASES,
};

const BAND: Band = Band::TACTILE;
/// Sample rate at which levels are measured, hertz.
const PLAYED_HZ: f64 = 2_000.0;

const METHODS: [&str; 4] = ["yule-walker", "burg", "covariance", "decibel"];

/// How a filter is refused as a parameter set, by magnitude and by voice.
fn filter_refused(coefficients: &[f64]) -> String {
    let ar = model("ar");
    let count = [coefficients.len() as f64];
    let parameters = [&count[..], coefficients, &[2_000.0]].concat();
    let magnitude = outcome_text(ar.magnitude(&parameters, BAND, &[100.0]));
    let voice = outcome_text(ar.voice(&parameters, BAND, 2_000.0, 1));
    if magnitude == voice { voice } else { format!("by magnitude {magnitude}; by voice {voice}") }
}

/// Whether fits of orders up to 64 at a model rate are stable with each method, and play.
fn fits_at(rate_hz: &str) -> f64 {
    let ar = model("ar");
    let (signal, mut results) = (friction(), Vec::new());
    let magnitude = spectrum(&signal);
    for method in METHODS {
        for order in ["1", "6", "33", "64"] {
            let options = [("order", order), ("rate_hz", rate_hz), ("method", method)];
            let fitted = fit_with(&ar, &magnitude, &signal[..1_000], &options).unwrap();
            let played = Stream::new(&ar, &fitted.parameters, BAND, RATE_HZ, 1)
                .and_then(|mut stream| stream.render(&mut [0.0; 200]));
            if played.is_err() {
                println!("{method} of order {order} at {rate_hz} Hz: {played:?}");
            }
            results.push(played.is_ok());
        }
    }
    failures(results)
}

/// Whether fits are stable in exact arithmetic, for orders that it can handle.
fn exactly_stable(rate_hz: &str) -> f64 {
    let ar = model("ar");
    let magnitude = spectrum(&friction());
    let stable = |order, method| {
        let options = [("order", order), ("rate_hz", rate_hz), ("method", method)];
        let fitted = fit_with(&ar, &magnitude, &[], &options).unwrap();
        let count = fitted.parameters[0] as usize;
        exact::is_stable(&fitted.parameters[1..=count])
    };
    failures(
        ["1", "2", "3", "6", "9", "12"]
            .map(|order| stable(order, "yule-walker") && stable(order, "decibel")),
    )
}

/// Error of the level of a fitted 1 N tone, and of its voice, decibels.
fn tone_level(hz: f64, method: &str) -> f64 {
    let ar = model("ar");
    let fitted = fit_with(&ar, &spectrum(&tone(hz)), &[], &[("method", method)]).unwrap();
    let level_db = 20.0 * (fitted.level_rms * 2f64.sqrt()).log10();
    let mut voice = ar.voice(&fitted.parameters, BAND, PLAYED_HZ, 1).unwrap();
    let mut out = vec![0.0f32; 240 * PLAYED_HZ as usize];
    voice.render(&mut out).unwrap();
    let power: f64 = out.iter().map(|&x| f64::from(x).powi(2)).sum();
    let played_db = 10.0 * (power / out.len() as f64).log10();
    worse(level_db.abs(), played_db.abs())
}

const CASES: &[Case] = &[
    within(
        "a tone of 100, 500 or 902.5 Hz",
        "AR",
        "level of the fit and of four minutes played",
        Bound(1.0, "dB", "the tone's"),
        || {
            let of = |hz| worse(tone_level(hz, "yule-walker"), tone_level(hz, "decibel"));
            [100.0, 500.0, 902.5].map(of).into_iter().fold(0.0, worse)
        },
    ),
    within(
        "friction noise, the band oversampled 1 to 500 times: model rates 2 kHz to 1 MHz",
        "AR",
        "fit by each method, orders 1 to 64, and render",
        none("all are played"),
        || ["2000", "20000", "200000", "1000000"].map(fits_at).iter().sum(),
    ),
    within(
        "friction noise, model rates 2 kHz to 200 kHz",
        "AR",
        "fit, orders 1 to 12",
        none("stable, exact"),
        || ["2000", "20000", "200000"].map(exactly_stable).iter().sum(),
    ),
    within(
        "white noise at a model rate of 50 Hz, below the band's middle",
        "AR",
        "fit and render",
        none("played or refused"),
        || {
            let ar = model("ar");
            let fitted = METHODS.map(|method| {
                let options = [("rate_hz", "50"), ("method", method)];
                fit_with(&ar, &spectrum(&noise()), &noise()[..1_000], &options)
            });
            failures(fitted.map(|fitted| {
                let played = fitted.map(|fit| {
                    Stream::new(&ar, &fit.parameters, BAND, RATE_HZ, 1)
                        .and_then(|mut stream| stream.render(&mut [0.0; 500]))
                });
                !matches!(played, Ok(Err(_)))
            }))
        },
    ),
    within(
        "poles at radius 1 - 1e-12 on and between bins",
        "AR",
        "magnitude, render",
        none("finite"),
        || {
            let ar = model("ar");
            let radius = 1.0 - 1e-12;
            failures([500.0, 502.5, 20.0, 999.9].map(|hz: f64| {
                let angle = std::f64::consts::TAU * hz / 2_000.0;
                let (a1, a2) = (2.0 * radius * angle.cos(), -radius * radius);
                let parameters = [2.0, a1, a2, 2_000.0];
                let grid = BAND.grid_hz();
                let magnitude = ar.magnitude(&parameters, BAND, &grid);
                let played = Stream::new(&ar, &parameters, BAND, RATE_HZ, 1)
                    .and_then(|mut stream| stream.render(&mut [0.0; 4_000]));
                magnitude.is_ok() && played.is_ok()
            }))
        },
    ),
    within(
        "a band that ends at 500 Hz, as recorded at 1 kHz",
        "AR",
        "fit",
        none("the model rate is 1 kHz; that of the tactile band stays 2 kHz"),
        || {
            let rate = |high_hz: f64| {
                let ar = model("ar");
                let band = Band { high_hz, ..BAND };
                let grid = band.grid_hz();
                let magnitude: Vec<f64> = grid.iter().map(|f| 1.0 / f).collect();
                let fitted = ar.fit(&FitInput {
                    band,
                    frequency_hz: &grid,
                    magnitude: &magnitude,
                    signal: &[],
                    signal_rate_hz: RATE_HZ,
                    options: &ar.options(&[]).unwrap(),
                    condition: FitCondition::default(),
                });
                fitted.unwrap().parameters.last().copied()
            };
            failures([rate(500.0) == Some(1_000.0), rate(1_000.0) == Some(2_000.0)])
        },
    ),
    within(
        "friction noise",
        "AR",
        "fit by each method",
        none("no two give the same filter"),
        || {
            let (ar, signal) = (model("ar"), friction());
            let magnitude = spectrum(&signal);
            let [a, b, c, d] = METHODS.map(|method| {
                let fitted = fit_with(&ar, &magnitude, &signal[..1_000], &[("method", method)]);
                fitted.unwrap().parameters
            });
            failures([a != b, b != c, a != c, a != d, b != d, c != d])
        },
    ),
    within(
        "a model rate of 500 Hz: nothing above 250 Hz",
        "AR",
        "magnitude",
        none("0 there, above 0 below"),
        || {
            let parameters = [1.0, 0.5, 500.0];
            let magnitude = model("ar").magnitude(&parameters, BAND, &[240.0, 260.0, 900.0]);
            failures([magnitude.is_ok_and(|m| m[0] > 0.0 && m[1] == 0.0 && m[2] == 0.0)])
        },
    ),
    refused(
        "a model rate of 50 Hz in a band that begins at 100 Hz",
        "AR",
        "magnitude",
        "InvalidParameters: the filter has no finite energy in the band",
        || {
            let band = Band { low_hz: 100.0, ..BAND };
            outcome_text(model("ar").magnitude(&[1.0, 0.5, 50.0], band, &[200.0]))
        },
    ),
    refused(
        "a signal of no sample or one",
        "AR",
        "fit by Burg's method",
        "CannotFit: this method needs the recording's segments",
        || {
            let magnitude = spectrum(&friction());
            let said = |signal: &[f64]| {
                let options = [("method", "burg")];
                outcome_text(fit_with(&model("ar"), &magnitude, signal, &options))
            };
            let (none, one) = (said(&[]), said(&[1.0]));
            if none == one { none } else { format!("{none}; {one}") }
        },
    ),
    refused(
        "a signal of silence",
        "AR",
        "fit by Burg's method",
        "CannotFit: the recording's segments are silent",
        || {
            let options = [("method", "burg")];
            outcome_text(fit_with(&model("ar"), &spectrum(&friction()), &[0.0; 100], &options))
        },
    ),
    refused(
        "a reflection coefficient of 1",
        "AR",
        "magnitude, voice",
        "InvalidParameters: the filter is not stable",
        || filter_refused(&[1.0]),
    ),
    refused(
        "a reflection coefficient of -1",
        "AR",
        "magnitude, voice",
        "InvalidParameters: the filter is not stable",
        || filter_refused(&[0.2, -1.0]),
    ),
    refused(
        "a pole outside the unit circle",
        "AR",
        "magnitude, voice",
        "InvalidParameters: the filter is not stable",
        || filter_refused(&[2.5, -1.2]),
    ),
    refused(
        "poles 1e-16 inside the circle and on a bin, where the magnitude rounds to infinity",
        "AR",
        "magnitude, voice",
        "InvalidParameters: the filter has no finite energy in the band",
        || {
            let all = [
                filter_refused(&[1.996_053_456_856_543_1, -0.999_999_999_999_999_9]),
                filter_refused(&[1.970_218_652_309_547_8, -0.999_999_999_999_999_9]),
                filter_refused(&[1.937_166_322_257_262_2, -0.999_999_999_999_999_9]),
                filter_refused(&[1.902_113_032_590_307, -0.999_999_999_999_999_8]),
            ];
            let other = all.iter().find(|text| !text.contains("no finite energy"));
            other.unwrap_or(&all[0]).clone()
        },
    ),
    refused("a coefficient that is NaN", "every model", "magnitude, voice", "is NaN", || {
        let said = models().into_iter().map(|model| {
            let fitted = crate::seen::fit(&model, &spectrum(&friction())).unwrap();
            let mut parameters = fitted.parameters;
            // A scalar's position, or the first of a list.
            let last = parameters.len() - 1;
            parameters[last] = f64::NAN;
            let grid = BAND.grid_hz();
            [
                outcome_text(model.magnitude(&parameters, BAND, &grid)),
                outcome_text(model.voice(&parameters, BAND, 2_000.0, 1)),
            ]
        });
        let all: Vec<String> = said.flatten().collect();
        let other = all.iter().find(|text| !text.contains("is NaN"));
        other.unwrap_or(&all[0]).clone()
    }),
];
