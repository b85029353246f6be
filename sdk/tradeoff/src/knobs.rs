//! Table of knobs: the options that a sweep varies, and their values.

use htex_host::FitOption;

/// A knob and its values in a sweep, besides its default.
#[derive(Debug, Clone, Copy)]
pub struct Knob {
    /// A fit option of the model, or one of [`PLAYING`].
    pub name: &'static str,
    /// Its values, from coarse to fine, as [`LoadedModel::options`](htex_host::LoadedModel::options) takes them.
    pub values: &'static [&'static str],
}

/// The fit options of a model.
#[derive(Debug, Clone, Copy)]
pub struct ModelKnobs {
    /// The model's short name.
    pub model: &'static str,
    /// Knobs that are varied in all combinations.
    pub together: &'static [Knob],
    /// Knobs that are varied one at a time, with the others at their defaults.
    pub alone: &'static [Knob],
    /// A knob that has no effect above the value of another.
    pub not_above: Option<(&'static str, &'static str)>,
}

const fn knob(name: &'static str, values: &'static [&'static str]) -> Knob {
    Knob { name, values }
}

/// Fit options by model, chosen by hand. Those of a model that is not listed come from its descriptor.
pub const MODELS: &[ModelKnobs] = &[
    ModelKnobs {
        model: "ar",
        together: &[
            knob(
                "order",
                &[
                    "2", "3", "4", "5", "6", "8", "10", "12", "16", "20", "24", "32", "40", "48",
                    "64",
                ],
            ),
            knob("rate_hz", &["2000", "2500", "4000"]),
        ],
        alone: &[knob("method", &["yule-walker", "burg", "covariance"])],
        not_above: None,
    },
    ModelKnobs {
        model: "mfcc",
        together: &[
            knob(
                "coefficients",
                &["4", "5", "6", "8", "10", "13", "16", "20", "26", "32", "40"],
            ),
            knob("bands", &["26", "40"]),
            knob("inverse", &["pinv", "nnls", "interpolate"]),
        ],
        alone: &[knob("bands", &["20", "32", "64"])],
        not_above: Some(("coefficients", "bands")),
    },
    ModelKnobs {
        model: "speak",
        together: &[
            knob(
                "count",
                &[
                    "1", "2", "3", "4", "6", "8", "10", "12", "16", "24", "32", "48", "64",
                ],
            ),
            knob("jnd", &["0.24", "0.12", "0.06", "0.03", "0"]),
        ],
        alone: &[],
        not_above: None,
    },
    ModelKnobs {
        model: "sbeta",
        together: &[
            knob(
                "points",
                &["3", "4", "5", "6", "8", "10", "15", "20", "30", "50"],
            ),
            knob("lower_bound", &["1", "0"]),
            knob("error", &["magnitude", "decibel"]),
        ],
        alone: &[knob("jnd", &["0.24", "0.12", "0.06", "0"])],
        not_above: None,
    },
    ModelKnobs {
        model: "sslope",
        together: &[
            knob("rounding_db_per_decade", &["20", "10", "5", "1"]),
            knob("slopes", &["least-squares", "end-points", "anchored"]),
        ],
        alone: &[],
        not_above: None,
    },
    ModelKnobs {
        model: "bands",
        together: &[
            knob(
                "bands",
                &[
                    "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "12", "14", "16", "19",
                    "20", "22", "24", "26", "28", "30", "34", "40", "48", "56", "64",
                ],
            ),
            knob("step_db", &["3", "1.5", "1", "0.75", "0.5", "0.25"]),
        ],
        alone: &[knob("layout", &["within"])],
        not_above: None,
    },
];

/// Options of storing and playing: varied one at a time, at the fit's defaults. Ways to load a
/// model are added to these.
pub const PLAYING: &[Knob] = &[
    knob(
        "synthesis",
        &[
            "loop:0.5",
            "loop:2",
            "loop:10",
            "filter:127",
            "filter:255",
            "filter:511",
            "filter:1023",
        ],
    ),
    knob("store", &["f32", "f64"]),
    knob("block_samples", &["1", "16", "64", "1024"]),
    knob("output_rate_hz", &["4000", "8000", "48000", "192000"]),
];

/// Values of an option of a model that is not listed.
const STEPS: i32 = 8;

/// Returns the values of an option in a sweep, from its descriptor: its choices, or numbers over its whole range, in equal
/// ratios if it is above 0.
pub(crate) fn of_range(option: &FitOption) -> Vec<String> {
    if !option.choices.is_empty() {
        return option.choices.clone();
    }
    let (min, max) = (option.min, option.max);
    let value = |step: i32| {
        let part = f64::from(step) / f64::from(STEPS);
        let value = match min > 0.0 {
            true => min * libm::pow(max / min, part),
            false => min + part * (max - min),
        };
        match option.integer {
            true => value.round().to_string(),
            false => format!("{value:.3e}")
                .parse::<f64>()
                .unwrap_or(value)
                .clamp(min, max)
                .to_string(),
        }
    };
    let mut values: Vec<String> = (0..=STEPS).map(value).collect();
    values.dedup();
    values
}

/// Returns the ends and the middle of a knob's values, for a quick sweep.
pub(crate) fn few<T: Clone>(values: &[T]) -> Vec<T> {
    let mut few = vec![0, values.len() / 2, values.len().saturating_sub(1)];
    few.dedup();
    few.into_iter()
        .filter_map(|i| values.get(i).cloned())
        .collect()
}
