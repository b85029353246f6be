//! Interpolation between models that have nothing in common.

use htex_dsp::line_spectrum::{
    from_line_spectral_frequencies, line_spectral_frequencies,
    line_spectral_frequencies_of_reflection,
};
use htex_dsp::linear_prediction::reflection_to_coefficients;
use htex_dsp::uniform::Uniform;
use htex_host::{Band, LoadedModel};

use crate::seen::{fit_with, model, models, outcome_text, spectrum};
use crate::signals::{far_apart, friction, impulse, noise, tone};
use crate::{Bound, Case, Section, exact, failures, none, refused, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "Interpolation",
    about: "Line spectral frequencies, and mixes of parameter sets.",
    cases: CASES,
};

const BAND: Band = Band::TACTILE;

/// Filters with reflection coefficients of at most `most` in absolute value.
fn filters(order: usize, most: f64, count: u64) -> Vec<Vec<f64>> {
    let filter = |seed| {
        let mut uniform = Uniform::new(seed);
        let k: Vec<f64> = (0..order).map(|_| most * (2.0 * uniform.next_unit() - 1.0)).collect();
        reflection_to_coefficients(&k)
    };
    (0..count).map(filter).collect()
}

/// A parameter set of AR.
fn set(coefficients: &[f64]) -> Vec<f64> {
    [&[coefficients.len() as f64], coefficients, &[2_000.0]].concat()
}

/// Number of half-way mixes, over all pairs of filters, that are refused or unstable without
/// rounding.
fn unstable_mixes(filters: &[Vec<f64>]) -> f64 {
    let ar = model("ar");
    let mut results = Vec::new();
    for a in filters {
        for b in filters {
            let mixed = ar.interpolate(&[&set(a), &set(b)], &[0.5, 0.5]);
            let stable = mixed.is_ok_and(|p| {
                let count = p[0] as usize;
                exact::is_stable(&p[1..=count])
            });
            results.push(stable);
        }
    }
    failures(results)
}

/// Extreme filters: poles near the circle at both ends and all around, and no poles.
fn extremes() -> Vec<Vec<f64>> {
    let near = 1.0 - 1e-6;
    let pair = |turn: f64| {
        let angle = std::f64::consts::TAU * turn;
        vec![2.0 * near * angle.cos(), -near * near]
    };
    vec![
        vec![near],
        vec![-near],
        vec![0.0, 0.0],
        pair(0.001),
        pair(0.25),
        pair(0.499),
        vec![0.0, 0.0, 0.0, 0.0, 0.0, near],
        vec![0.0, 0.0, 0.0, 0.0, 0.0, -near],
    ]
}

/// Largest error of coefficients after conversion to line spectral frequencies and back.
fn round_trip(filters: &[Vec<f64>]) -> f64 {
    let off = filters.iter().map(|a| {
        let back = line_spectral_frequencies(a).and_then(|w| from_line_spectral_frequencies(&w));
        let largest = a.iter().fold(1.0f64, |m, a| m.max(a.abs()));
        back.map_or(f64::NAN, |back| {
            let off = a.iter().zip(&back).map(|(a, b)| (a - b).abs() / largest);
            off.fold(0.0, worse)
        })
    });
    off.fold(0.0, worse)
}

/// Two nonzero samples, 3 ms apart. Their spectrum is a comb.
fn clicks() -> Vec<f64> {
    let first = impulse();
    let delayed = std::iter::repeat_n(0.0, 60).chain(first.iter().copied());
    first.iter().zip(delayed).map(|(x, y)| x + 0.5 * y).collect()
}

/// Whether mixes of fits to unlike recordings, also at weights near 0 and 1, are shapes that play.
fn mixes(model: &LoadedModel) -> Vec<bool> {
    let recordings = [noise(), friction(), clicks(), tone(300.0), far_apart()];
    let fitted: Vec<Vec<f64>> = recordings
        .iter()
        .map(|x| crate::seen::fit(model, &spectrum(x)).unwrap().parameters)
        .collect();
    let mut results = Vec::new();
    for a in &fitted {
        for b in &fitted {
            for weight in [0.0, 1e-300, 1e-12, 0.5, 1.0 - 1e-12] {
                let mixed = model.interpolate(&[a, b], &[weight, 1.0 - weight]);
                let played = mixed.and_then(|p| {
                    model.magnitude(&p, BAND, &BAND.grid_hz())?;
                    let rate_hz = model.voice_rate_hz(&p, BAND, 20_000.0)?;
                    model.voice(&p, BAND, rate_hz, 1)?.render(&mut [0.0; 100])
                });
                results.push(played.is_ok());
            }
        }
    }
    results
}

const CASES: &[Case] = &[
    within(
        "poles 1e-6 inside the circle at 0, ±0.001, ±0.25, ±0.499 turns, six all around, none",
        "AR",
        "mix of each two, half and half",
        none("stable, exact"),
        || unstable_mixes(&extremes()),
    ),
    within(
        "12 filters of order 6, reflection up to ±0.999",
        "AR",
        "mix of each two, half and half",
        none("stable, exact"),
        || unstable_mixes(&filters(6, 0.999, 12)),
    ),
    within(
        "4 filters of order 16, reflection up to ±0.9",
        "AR",
        "mix of each two, half and half",
        none("stable, exact"),
        || unstable_mixes(&filters(16, 0.9, 4)),
    ),
    within(
        "3 filters of order 64, reflection up to ±0.3",
        "AR",
        "mix of each two, half and half",
        none("finite"),
        || {
            let ar = model("ar");
            let filters = filters(64, 0.3, 3);
            failures(filters.iter().flat_map(|a| {
                filters.iter().map(|b| {
                    let mixed = ar.interpolate(&[&set(a), &set(b)], &[0.5, 0.5]);
                    mixed.is_ok_and(|p| ar.magnitude(&p, BAND, &BAND.grid_hz()).is_ok())
                })
            }))
        },
    ),
    within(
        "filters of order 1 to 16, reflection up to ±0.9",
        "line spectral frequencies",
        "there and back",
        Bound(1e-10, "of the largest coefficient", "the filter"),
        || (1..=16).map(|order| round_trip(&filters(order, 0.9, 8))).fold(0.0, worse),
    ),
    within(
        "poles 1e-6 inside the circle",
        "line spectral frequencies",
        "there and back",
        Bound(1e-12, "of the largest coefficient", "the filter"),
        || round_trip(&extremes()),
    ),
    within(
        "orders 1 to 16, reflection ±(1 - 1e-1) to ±(1 - 1e-6)",
        "line spectral frequencies",
        "find",
        none("in order, in 0 to π, however near"),
        || {
            failures((1..=400).map(|seed| {
                let mut uniform = Uniform::new(seed);
                let reflection: Vec<f64> = (0..1 + seed % 16)
                    .map(|_| {
                        let k = 1.0 - 10f64.powf(-1.0 - 5.0 * uniform.next_unit());
                        k.copysign(uniform.next_unit() - 0.5)
                    })
                    .collect();
                let lines = line_spectral_frequencies_of_reflection(&reflection);
                let bounded = [&[0.0], &lines[..], &[std::f64::consts::PI]].concat();
                bounded.is_sorted()
            }))
        },
    ),
    within(
        "frequencies that touch, cross, leave (0, π), or are NaN; more than 128",
        "line spectral frequencies",
        "to a filter",
        none("refused"),
        || {
            let bad: [&[f64]; 7] = [
                &[1.0, 1.0],
                &[1.1, 1.0],
                &[0.0, 1.0],
                &[1.0, std::f64::consts::PI],
                &[-0.1, 1.0],
                &[f64::NAN, 1.0],
                &[1.0, f64::INFINITY],
            ];
            let many: Vec<f64> = (1..=129).map(|i| f64::from(i) * 0.02).collect();
            let all = bad.iter().copied().chain([&many[..]]);
            failures(all.map(|w| from_line_spectral_frequencies(w).is_none()))
        },
    ),
    within(
        "white noise, friction noise, an impulse, a tone, tones 120 dB apart",
        "every model",
        "mix of each two, weights from 1e-300 to 1, magnitude, render",
        none("played"),
        || failures(models().iter().flat_map(mixes)),
    ),
    refused(
        "weights that do not sum to 1, are negative, or NaN",
        "every model",
        "mix",
        "InvalidArgument: weights must lie in 0 to 1 and sum to 1",
        || {
            let said = models().into_iter().flat_map(|model| {
                let set = crate::seen::fit(&model, &spectrum(&friction())).unwrap().parameters;
                let sets = [&set[..], &set[..]];
                let weights = [[0.5, 0.6], [-0.5, 1.5], [f64::NAN, 1.0], [0.0, 0.0]];
                weights.map(|weights| outcome_text(model.interpolate(&sets, &weights)))
            });
            let all: Vec<String> = said.collect();
            let other = all.iter().find(|text| !text.contains("sum to 1"));
            other.unwrap_or(&all[0]).clone()
        },
    ),
    refused(
        "filters of 2 kHz and 4 kHz",
        "AR",
        "mix",
        "InvalidArgument: filters of different model rates cannot be mixed",
        || {
            let (a, b) = ([1.0, 0.5, 2_000.0], [1.0, 0.5, 4_000.0]);
            outcome_text(model("ar").interpolate(&[&a, &b], &[0.5, 0.5]))
        },
    ),
    refused(
        "an unstable filter and a stable one",
        "AR",
        "mix",
        "InvalidParameters: the filter is not stable",
        || {
            let (a, b) = ([1.0, 0.5, 2_000.0], [1.0, 1.0, 2_000.0]);
            outcome_text(model("ar").interpolate(&[&a, &b], &[0.5, 0.5]))
        },
    ),
    within(
        "one sinusoid and another; one and two",
        "sPeak",
        "mix, half and half",
        none("one between them; three, faded"),
        || {
            let speak = model("speak");
            let (a, b) = ([1.0, 100.0, 1.0, 1.4, 0.0], [1.0, 200.0, 1.0, 1.4, 0.0]);
            let two = [2.0, 50.0, 70.0, 2.0, 1.0, 1.0, 0.0];
            let glided = speak.interpolate(&[&a, &b], &[0.5, 0.5]);
            let faded = speak.interpolate(&[&a, &two], &[0.5, 0.5]);
            failures([
                glided.is_ok_and(|p| p == [1.0, 150.0, 1.0, 1.4, 0.0]),
                faded.is_ok_and(|p| p[0] == 3.0 && p[1..4] == [100.0, 50.0, 70.0]),
            ])
        },
    ),
    refused(
        "33 and 34 sinusoids",
        "sPeak",
        "mix",
        "InvalidArgument: the sets have 67 lines together; 64 are allowed",
        || {
            let set = |count: usize| {
                let f: Vec<f64> = (0..count).map(|i| 20.0 + i as f64).collect();
                let a = vec![0.2; count];
                [&[count as f64], &f[..], &[count as f64], &a, &[0.0]].concat()
            };
            outcome_text(model("speak").interpolate(&[&set(33), &set(34)], &[0.5, 0.5]))
        },
    ),
    refused(
        "cepstra of 26 and 20 bands",
        "MFCC",
        "mix",
        "InvalidArgument: cepstra of different mel banks",
        || {
            let mfcc = model("mfcc");
            let magnitude = spectrum(&friction());
            let set = |bands| {
                let fitted = fit_with(&mfcc, &magnitude, &[], &[("bands", bands)]);
                fitted.unwrap().parameters
            };
            outcome_text(mfcc.interpolate(&[&set("26"), &set("20")], &[0.5, 0.5]))
        },
    ),
];
