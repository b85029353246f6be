//! The knobs of a sweep, i.e. the settings that the sweep varies: options for storing and playing,
//! and the fit options of models. If a model's descriptor lists no values for a fit option
//! ([`FitOption::sweep`]), this module chooses the values.

use htex_host::FitOption;

/// Options for storing and playing. They are varied one at a time, with the fit options at their
/// defaults. A sweep also varies the way in which a model is loaded.
pub(crate) const PLAYING: &[(&str, &[&str])] = &[
    (
        "synthesis",
        &["loop:0.5", "loop:2", "loop:10", "filter:127", "filter:255", "filter:511", "filter:1023"],
    ),
    ("store", &["f32", "f64"]),
    ("block_samples", &["1", "16", "64", "1024"]),
    ("output_rate_hz", &["4000", "8000", "48000", "192000"]),
];

/// Number of values, minus one, for an option for which the model lists no values.
const STEPS: i32 = 8;

/// Returns an option's values for a sweep, from its descriptor: its choices, or numbers over its
/// whole range. If the range is above 0, the numbers form a geometric series.
pub(crate) fn of_range(option: &FitOption) -> Vec<String> {
    if !option.choices.is_empty() {
        return option.choices.clone();
    }
    let (min, max) = (option.min, option.max);
    let value = |step: i32| {
        let part = f64::from(step) / f64::from(STEPS);
        let value =
            if min > 0.0 { min * libm::pow(max / min, part) } else { min + part * (max - min) };
        if option.integer {
            value.round().to_string()
        } else {
            format!("{value:.3e}").parse::<f64>().unwrap_or(value).clamp(min, max).to_string()
        }
    };
    let mut values: Vec<String> = (0..=STEPS).map(value).collect();
    values.dedup();
    values
}

/// Returns the two ends and the middle of a knob's values, for a quick sweep.
pub(crate) fn few<T: Clone>(values: &[T]) -> Vec<T> {
    let mut few = vec![0, values.len() / 2, values.len().saturating_sub(1)];
    few.dedup();
    few.into_iter().filter_map(|i| values.get(i).cloned()).collect()
}
