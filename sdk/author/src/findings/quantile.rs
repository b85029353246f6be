//! Medians and other quantiles of long signals.

/// Most values that are sorted: quantiles of as many, evenly spaced, scatter by less than a percent.
const MOST: usize = 20_000;

/// The value below which a part of the values lies, 0 to 1; of long signals a sample, evenly spaced.
/// None of no values.
pub(crate) fn quantile(part: f64, len: usize, value: impl Fn(usize) -> f64) -> Option<f64> {
    let mut values: Vec<f64> = (0..len)
        .step_by(len.div_ceil(MOST).max(1))
        .map(value)
        .collect();
    let last = values.len().checked_sub(1)?;
    let at = (part * last as f64).round() as usize;
    Some(*values.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// The median of a list; none of an empty one.
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    quantile(0.5, values.len(), |at| values[at])
}
