//! Linear prediction where the autocorrelation is singular or the filter nearly unstable.

use htex_dsp::estimation::{autocorrelation, burg, covariance, yule_walker};
use htex_dsp::lattice::AllPoleLattice;
use htex_dsp::linear_prediction::{
    ar_magnitude, coefficients_to_reflection, is_stable, levinson_durbin,
    reflection_to_coefficients, stabilize, within_radius,
};

use crate::big::{Big, big};
use crate::signals::{friction, noise, scaled, sum, tone};
use crate::{Bound, Case, Section, exact, failures, none, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "Linear prediction",
    about: "Levinson–Durbin, Burg, covariance, and the filters they give. A filter is *stable* if its exact \
            reflection coefficients lie inside (-1, 1).",
    cases: CASES,
};

const LEVINSON: &str = "Levinson–Durbin";
const FILTER: &str = "all-pole filter";
/// Distance of a pole inside the unit circle.
const RIM: f64 = 1e-12;

/// A resonance with its poles [`RIM`] inside the circle, at a 20th of the rate's turn.
fn rim() -> [f64; 2] {
    let radius = 1.0 - RIM;
    [2.0 * radius * (std::f64::consts::TAU / 20.0).cos(), -radius * radius]
}

/// Largest relative error of reflection coefficients and error power, ulps.
fn levinson_error(signal: &[f64], order: usize) -> f64 {
    let lags = autocorrelation(&[signal], order);
    let model = levinson_durbin(&lags, order);
    let (reflection, error) = exact::levinson(&lags, order);
    let pairs = model.reflection.iter().zip(&reflection);
    let off = pairs.map(|(k, exact)| exact::relative_error(*k, exact));
    off.fold(exact::relative_error(model.error, &error), worse) / f64::EPSILON
}

/// `|H|` in 256 bits.
fn magnitude(coefficients: &[f64], hz: f64, rate_hz: f64) -> Big {
    let omega = big(2.0) * Big::pi() * big(hz) / big(rate_hz);
    let (mut re, mut im) = (big(1.0), big(0.0));
    for (i, &a) in coefficients.iter().enumerate() {
        let angle = omega.clone() * big((i + 1) as f64);
        re = re - big(a) * angle.cos();
        im = im + big(a) * angle.sin();
    }
    big(1.0) / (re.clone() * re + im.clone() * im).sqrt()
}

fn magnitude_error(coefficients: &[f64], hz: &[f64], rate_hz: f64) -> f64 {
    let off = hz.iter().map(|&hz| {
        let reference = magnitude(coefficients, hz, rate_hz);
        reference.relative_error(ar_magnitude(coefficients, hz, rate_hz))
    });
    off.fold(0.0, worse)
}

/// Whether estimates of orders up to 64 are stable and have a finite error.
fn all_orders(signal: &[f64]) -> f64 {
    let estimates = [yule_walker, burg, covariance];
    let orders = [1, 2, 3, 6, 7, 16, 17, 31, 64];
    failures(estimates.iter().flat_map(|estimate| {
        orders.iter().map(|&order| {
            let model = estimate(&[signal], order);
            let inside = model.reflection.iter().all(|k| k.abs() < 1.0);
            inside && model.error.is_finite() && model.error >= 0.0
        })
    }))
}

/// A low-pass signal, oversampled by a factor: ten poles at 0 Hz.
fn oversampled(times: f64) -> Vec<f64> {
    let mut x = noise();
    x.truncate(20_000);
    for _ in 0..10 {
        let (mut y, keep) = (0.0, 1.0 - 1.0 / times);
        for x in &mut x {
            y = keep * y + (1.0 - keep) * *x;
            *x = y;
        }
    }
    x
}

/// The largest sample that a lattice at the rim makes from a million samples of noise, relative to
/// the root of their number. It accumulates nearly everything it ever received.
fn rim_run(reflection: &[f64]) -> f64 {
    let mut lattice = AllPoleLattice::new(reflection);
    let mut noise = htex_dsp::noise::GaussianNoise::new(3);
    let mut block = [0.0; 1_000];
    let (mut largest, mut count) = (0.0, 0.0);
    for _ in 0..1_000 {
        block.fill_with(|| noise.next_sample().into());
        lattice.process(&mut block);
        count += block.len() as f64;
        largest = block.iter().fold(largest, |a, x| worse(a, x.abs()));
    }
    largest / f64::sqrt(count)
}

/// Number of samples until a filter that rings with 0.9 is exactly at rest after an impulse.
fn samples_to_rest() -> f64 {
    let mut lattice = AllPoleLattice::new(&[0.3, -0.81]);
    lattice.tick(1.0);
    let last = (1..=100_000).rev();
    let out: Vec<f64> = (1..=100_000).map(|_| lattice.tick(0.0)).collect();
    if out.iter().any(|x| x.is_subnormal()) {
        return f64::NAN;
    }
    let sounding = last.zip(out.iter().rev()).find(|(_, x)| **x != 0.0);
    sounding.map_or(0.0, |(i, _)| f64::from(i))
}

const CASES: &[Case] = &[
    within("white noise, order 16", LEVINSON, "solve", Bound(100.0, "ulps", "exact"), || {
        levinson_error(&noise()[..4_000], 16)
    }),
    within("friction noise, order 6", LEVINSON, "solve", Bound(1e5, "ulps", "exact"), || {
        levinson_error(&friction()[..4_000], 6)
    }),
    within(
        "a tone and noise 60 dB below, order 6",
        LEVINSON,
        "solve",
        Bound(1e6, "ulps", "exact"),
        || levinson_error(&sum(&tone(500.0), &scaled(&noise(), 1e-3))[..4_000], 6),
    ),
    within(
        "perfect correlation, r = 1, ±1, 1, …",
        LEVINSON,
        "solve, orders 1 to 64",
        none("stable, error above 0"),
        || {
            failures((1..=64).flat_map(|order| {
                [1.0, -1.0].map(|sign: f64| {
                    let lags: Vec<f64> = (0..=order).map(|m| sign.powi(m)).collect();
                    let model = levinson_durbin(&lags, order as usize);
                    let k = model.reflection[0];
                    let limited = k.abs() < 1.0 && k.abs() > 0.999_999 && model.adjusted;
                    limited && exact::is_stable(&model.coefficients) && model.error > 0.0
                })
            }))
        },
    ),
    within(
        "lags that are not an autocorrelation: larger than r[0], NaN, infinite",
        LEVINSON,
        "solve",
        none("stable"),
        || {
            let bad = [f64::NAN, f64::INFINITY, -f64::INFINITY, 2.0, -1e300, 1e300];
            failures(bad.iter().flat_map(|&bad| {
                [[1.0, bad, 0.0], [1.0, 0.5, bad], [bad, 0.5, 0.25]].map(|lags| {
                    let model = levinson_durbin(&lags, 2);
                    exact::is_stable(&model.coefficients) && model.error >= 0.0
                })
            }))
        },
    ),
    within(
        "ten poles at 0 Hz, oversampled 10 times",
        "Yule–Walker, Burg, covariance",
        "estimate, orders 1 to 64",
        none("reflection inside (-1, 1), error finite"),
        || all_orders(&oversampled(10.0)),
    ),
    within(
        "ten poles at 0 Hz, oversampled 100 times",
        "Yule–Walker, Burg, covariance",
        "estimate, orders 1 to 64",
        none("reflection inside (-1, 1), error finite"),
        || all_orders(&oversampled(100.0)),
    ),
    within(
        "a pure tone",
        "Yule–Walker, Burg, covariance",
        "estimate, orders 1 to 64",
        none("reflection inside (-1, 1), error finite"),
        || all_orders(&tone(500.0)[..4_000]),
    ),
    within(
        "silence; fewer samples than the order; 1e-160 N; 1e150 N",
        "Yule–Walker, Burg, covariance",
        "estimate, orders 1 to 64",
        none("reflection inside (-1, 1), error finite"),
        || {
            let friction = &friction()[..2_000];
            all_orders(&[0.0; 500])
                + all_orders(&friction[..30])
                + all_orders(&scaled(friction, 1e-160))
                + all_orders(&scaled(friction, 1e150))
        },
    ),
    within(
        "poles at radius 1 - 1e-12",
        FILTER,
        "magnitude off the resonance",
        Bound(1e-13, "of it", "256 bits"),
        || magnitude_error(&rim(), &[20.0, 100.0, 900.0, 1_100.0, 9_999.0], 20_000.0),
    ),
    within(
        "poles at radius 1 - 1e-12",
        FILTER,
        "magnitude at the resonance",
        Bound(1e-3, "of it", "256 bits"),
        || magnitude_error(&rim(), &[1_000.0], 20_000.0),
    ),
    within(
        "poles at radius 1 - 1e-12",
        FILTER,
        "coefficients to reflection",
        Bound(4.0, "ulps", "exact"),
        || {
            let found = coefficients_to_reflection(&rim()).unwrap_or_default();
            let reference = exact::step_down(&rim()).unwrap();
            let pairs = found.iter().zip(&reference);
            let off = pairs.map(|(k, exact)| exact::relative_error(*k, exact));
            off.fold(2.0 - found.len() as f64, worse) / f64::EPSILON
        },
    ),
    within(
        "reflection coefficients 1 - 1e-12 and -(1 - 1e-12)",
        "lattice",
        "a million samples of noise",
        Bound(10.0, "× √samples", "output, a random walk,"),
        || {
            let k = 1.0 - RIM;
            worse(rim_run(&[k]), worse(rim_run(&[-k]), rim_run(&[0.1, -k])))
        },
    ),
    within(
        "an impulse, then silence",
        "lattice",
        "ring out",
        Bound(50_000.0, "samples", "never subnormal, exactly 0"),
        samples_to_rest,
    ),
    within(
        "poles on and outside the unit circle, NaN, 1e300",
        FILTER,
        "is it stable",
        none("never said to be stable"),
        || {
            let bad: [&[f64]; 8] = [
                &[1.0],
                &[-1.0],
                &[2.0, -1.0],
                &[0.0, 1.0],
                &[f64::NAN],
                &[0.5, f64::NAN],
                &[f64::INFINITY, 0.1],
                &[1e300, -0.9],
            ];
            failures(bad.iter().map(|a| !is_stable(a)))
        },
    ),
    within(
        "poles on and outside the unit circle, not finite",
        FILTER,
        "draw inside: by mirror, and to a radius of 0.99",
        none("stable"),
        || {
            let bad: [&[f64]; 6] = [
                &[1.0],
                &[2.0, -1.0],
                &[3.0, -9.0],
                &[0.0, 0.0, 1e6],
                &[f64::NAN, 0.1],
                &[f64::INFINITY],
            ];
            failures(bad.iter().flat_map(|a| {
                let narrowed = within_radius(a, 0.99);
                let further: Vec<f64> = htex_dsp::linear_prediction::scale_poles(&narrowed, 1.009);
                [
                    exact::is_stable(&stabilize(a)),
                    exact::is_stable(&narrowed),
                    exact::is_stable(&further),
                ]
            }))
        },
    ),
    within(
        "64 reflection coefficients of ±0.9",
        FILTER,
        "to coefficients and back",
        none("stable or refused, never NaN"),
        || {
            let k: Vec<f64> = (0..64).map(|i| if i % 3 == 0 { 0.9 } else { -0.9 }).collect();
            let a = reflection_to_coefficients(&k);
            let back = coefficients_to_reflection(&a);
            let sane = back.is_none_or(|k| k.iter().all(|k| k.abs() < 1.0));
            failures([a.iter().all(|a| a.is_finite()), sane])
        },
    ),
];
