//! Butterworth filters and sSlope at their limits.

use htex_dsp::biquad::{Biquad, Cascade};
use htex_dsp::butterworth::{analog_low_pass_magnitude, high_pass, low_pass};
use htex_dsp::grid::level_rms;
use htex_host::Band;

use crate::big::{Big, big};
use crate::seen::{fit_with, model, models, outcome_text};
use crate::{Bound, Case, Section, failures, none, refused, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "Slopes",
    about: "Butterworth magnitudes and sections against 256 bits, and sSlope at the edges of the band and of the \
            order.",
    cases: CASES,
};

const BAND: Band = Band::TACTILE;
const RATE_HZ: f64 = 20_000.0;

/// `1 / sqrt(1 + ratio^(2 order))` in 256 bits.
fn butterworth(ratio: &Big, order: f64) -> Big {
    let power = ratio.pow(&(big(2.0) * big(order)));
    big(1.0) / (big(1.0) + power).sqrt()
}

/// Difference between digital low- and high-pass sections and the bilinear transform, decibels,
/// where they pass more than -200 dB.
fn section_error_db(order: usize, cutoff_hz: f64) -> f64 {
    let tan = |hz: f64| {
        let angle = Big::pi() * big(hz) / big(RATE_HZ);
        angle.sin() / angle.cos()
    };
    let mut worst = 0.0;
    for (design, high) in [(low_pass as fn(_, _, _) -> _, false), (high_pass, true)] {
        let Some(sections) = design(order, cutoff_hz, RATE_HZ) else {
            return f64::NAN;
        };
        let cascade = Cascade::new(&sections);
        for hz in [1.0, 20.0, 300.0, cutoff_hz, 1_000.0, 5_000.0, 9_000.0, 9_990.0] {
            let ratio = tan(hz) / tan(cutoff_hz);
            let ratio = if high { big(1.0) / ratio } else { ratio };
            let reference = butterworth(&ratio, order as f64).to_f64();
            if reference > 1e-10 {
                let off = 20.0 * (cascade.magnitude(hz, RATE_HZ) / reference).log10();
                worst = worse(worst, off.abs());
            }
        }
    }
    worst
}

/// Relative error of sSlope's magnitude between two frequencies, compared with 256 bits.
fn shape_error(peak_hz: f64, orders: (f64, f64)) -> f64 {
    let grid = BAND.grid_hz();
    let set = [peak_hz, orders.0, orders.1];
    let Ok(found) = model("sslope").magnitude(&set, BAND, &grid) else {
        return f64::NAN;
    };
    if (level_rms(&found) - 1.0).abs() > 1e-9 {
        return f64::NAN;
    }
    let at = |hz: f64| {
        let above = big(hz) / big(peak_hz);
        butterworth(&above, orders.1) * butterworth(&(big(1.0) / above), orders.0)
    };
    // Relative to the largest value: the scale of the shape belongs to its level.
    let top = (0..grid.len()).max_by(|&a, &b| found[a].total_cmp(&found[b])).unwrap();
    let largest = at(grid[top]);
    let off = [0, 1, 13, 97, 195, 196].map(|i: usize| {
        let reference = at(grid[i]) / largest.clone();
        reference.relative_error(found[i] / found[top])
    });
    off.into_iter().fold(0.0, worse)
}

/// Orders with which a spectrum is fitted. They must be in range, and the shape must play.
fn orders(magnitude: &[f64], slopes: &str) -> Option<[f64; 3]> {
    let sslope = model("sslope");
    let fitted = fit_with(&sslope, magnitude, &[], &[("slopes", slopes)]).ok()?;
    let set = [fitted.parameters[0], fitted.parameters[1], fitted.parameters[2]];
    let played =
        sslope.voice(&set, BAND, 2_500.0, 1).and_then(|mut voice| voice.render(&mut [0.0; 1_000]));
    let sane = set[1..].iter().all(|order| (0.05..=20.0).contains(order));
    (sane && played.is_ok() && fitted.level_rms > 0.0).then_some(set)
}

/// Whether the orders are as wanted with each way of measuring slopes.
fn all_ways(magnitude: &[f64], wanted: [f64; 3]) -> [bool; 3] {
    ["least-squares", "end-points", "anchored"]
        .map(|slopes| orders(magnitude, slopes) == Some(wanted))
}

/// A spectrum that falls on both sides of a peak, by decibels per decade.
fn roof(peak_hz: f64, db_per_decade: f64) -> Vec<f64> {
    let at = |f: f64| -db_per_decade * (f / peak_hz).log10().abs();
    BAND.grid_hz().into_iter().map(|f| 10f64.powf(at(f) / 20.0)).collect()
}

const ENDS: &str = "1 N at 20 Hz, 1 N at 1 kHz, nothing between";

fn ends() -> Vec<f64> {
    let mut magnitude = vec![0.0; 197];
    (magnitude[0], magnitude[196]) = (1.0, 1.0);
    magnitude
}

const CASES: &[Case] = &[
    within(
        "orders 1 to 20, cut-off 20 Hz at 20 kHz",
        "Butterworth sections",
        "magnitude where it is above -200 dB",
        Bound(1e-8, "dB", "256 bits"),
        || {
            [1, 2, 3, 8, 19, 20]
                .map(|order| section_error_db(order, 20.0))
                .into_iter()
                .fold(0.0, worse)
        },
    ),
    within(
        "orders 1 to 20, cut-off 9990 Hz at 20 kHz",
        "Butterworth sections",
        "magnitude where it is above -200 dB",
        Bound(1e-8, "dB", "256 bits"),
        || {
            [1, 2, 3, 8, 19, 20]
                .map(|order| section_error_db(order, 9_990.0))
                .into_iter()
                .fold(0.0, worse)
        },
    ),
    within(
        "order 20, cut-offs 1 Hz to a millihertz below Nyquist",
        "Butterworth sections",
        "a second of noise",
        none("stable and finite"),
        || {
            let results = [1.0, 20.0, 5_000.0, 9_999.0, 9_999.999].map(|cutoff_hz| {
                [low_pass(20, cutoff_hz, RATE_HZ), high_pass(20, cutoff_hz, RATE_HZ)].map(
                    |sections| {
                        let sections = sections.unwrap();
                        let mut block = crate::signals::noise();
                        Cascade::new(&sections).process(&mut block);
                        sections.iter().all(Biquad::is_stable)
                            && block.iter().all(|x| x.abs() < 100.0)
                    },
                )
            });
            failures(results.into_iter().flatten())
        },
    ),
    within(
        "cut-off 0, negative, at and above Nyquist, NaN; orders 0 and 21; a rate that is NaN or infinite",
        "Butterworth sections",
        "design",
        none("refused"),
        || {
            let bad = [
                (2, 0.0, RATE_HZ),
                (2, -5.0, RATE_HZ),
                (2, 10_000.0, RATE_HZ),
                (2, 11_000.0, RATE_HZ),
                (2, f64::NAN, RATE_HZ),
                (0, 100.0, RATE_HZ),
                (21, 100.0, RATE_HZ),
                (2, 100.0, f64::NAN),
                (2, 100.0, f64::INFINITY),
            ];
            failures(bad.iter().flat_map(|&(order, hz, rate)| {
                [low_pass(order, hz, rate).is_none(), high_pass(order, hz, rate).is_none()]
            }))
        },
    ),
    within(
        "notches at 1 to 9999 Hz, at their own frequency",
        "filter sections",
        "magnitude",
        Bound(1e-6, "of the pass band", "0"),
        || {
            let at = |hz: u32| {
                let hz = f64::from(hz);
                let notch = Biquad {
                    b1: -2.0 * (std::f64::consts::TAU * hz / RATE_HZ).cos(),
                    b2: 1.0,
                    ..Biquad::IDENTITY
                };
                notch.magnitude(hz, RATE_HZ)
            };
            (1..10_000).map(at).fold(0.0, worse)
        },
    ),
    within(
        "0 to 1e300 Hz, order 20",
        "analogue Butterworth magnitude",
        "evaluate",
        none("0 to 1"),
        || {
            failures([0.0, 1e-300, 1.0, 1e18, 1e300].map(|hz| {
                let m = analog_low_pass_magnitude(hz / 100.0, 20.0);
                (0.0..=1.0).contains(&m)
            }))
        },
    ),
    within(
        "peak 1, 20, 140, 1000, 2000 Hz; orders 0.05, 1, 7.3, 20",
        "sSlope",
        "magnitude",
        Bound(1e-13, "of it", "256 bits"),
        || {
            let mut worst = 0.0;
            for peak_hz in [1.0, 20.0, 140.0, 1_000.0, 2_000.0] {
                for low in [0.05, 1.0, 7.3, 20.0] {
                    for high in [0.05, 20.0] {
                        worst = worse(worst, shape_error(peak_hz, (high, low)));
                    }
                }
            }
            worst
        },
    ),
    within(
        "a flat spectrum",
        "sSlope",
        "fit, each way of measuring",
        none("the peak is the first bin, both orders are the lowest, 1/4"),
        || failures(all_ways(&[1.0; 197], [20.0, 0.25, 0.25])),
    ),
    within(
        "the peak on the first and on the last bin, 60 dB/decade beside it",
        "sSlope",
        "fit, each way of measuring",
        none("order 3 where there is a side, 1/4 where there is none"),
        || {
            let first = all_ways(&roof(20.0, 60.0), [20.0, 0.25, 3.0]);
            let last = all_ways(&roof(1_000.0, 60.0), [1_000.0, 3.0, 0.25]);
            failures(first.into_iter().chain(last))
        },
    ),
    within(
        "slopes of 400 and 460 dB/decade",
        "sSlope",
        "fit, each way of measuring",
        none("order 20"),
        || {
            let steep =
                [400.0, 460.0].map(|slope| all_ways(&roof(140.0, slope), [140.0, 20.0, 20.0]));
            failures(steep.into_iter().flatten())
        },
    ),
    within(
        "slopes of 1000 and 5000 dB/decade, down to numbers that f64 has not",
        "sSlope",
        "fit, each way of measuring",
        none("in range and played"),
        || {
            let steep = [roof(140.0, 1_000.0), roof(140.0, 5_000.0)];
            let ways = ["least-squares", "end-points", "anchored"];
            let fitted = |m: &Vec<f64>| ways.map(|way| orders(m, way).is_some());
            failures(steep.iter().flat_map(fitted))
        },
    ),
    within(
        "one bin above nothing: 20, 140, 1000 Hz",
        "sSlope",
        "fit, each way of measuring",
        none("in range and played"),
        || {
            failures([0usize, 24, 196].into_iter().flat_map(|bin| {
                let mut magnitude = vec![0.0; 197];
                magnitude[bin] = 1.0;
                ["least-squares", "end-points", "anchored"]
                    .map(|way| orders(&magnitude, way).is_some())
            }))
        },
    ),
    within(ENDS, "every model but sPeak", "fit, magnitude", none("unit RMS"), || {
        let fits = models().into_iter().filter(|m| m.short_name() != "speak");
        failures(fits.map(|model| {
            let fitted = crate::seen::fit(&model, &ends());
            let shape = fitted.and_then(|f| model.magnitude(&f.parameters, BAND, &BAND.grid_hz()));
            shape.is_ok_and(|m| (level_rms(&m) - 1.0).abs() < 1e-9)
        }))
    }),
    within(ENDS, "sPeak", "fit", none("a line at each edge, as strong"), || {
        let fitted = crate::seen::fit(&model("speak"), &ends());
        // The bins of the band contain 5/6 of the power of either.
        let amplitude = 1.2f64.sqrt();
        let lines = [2.0, 20.0, 1000.0, 2.0, amplitude, amplitude, 1.0];
        let equal = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12;
        failures([fitted.is_ok_and(|f| f.parameters.iter().zip(&lines).all(equal))])
    }),
    refused(ENDS, "nine bands, whose triangles weigh nothing there", "fit", "CannotFit", || {
        let nine = [("bands", "9")];
        outcome_text(crate::seen::fit_with(&model("bands"), &ends(), &[], &nine))
    }),
];
