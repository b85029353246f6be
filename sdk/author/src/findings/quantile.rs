//! Quantiles of long signals.

/// Largest number of values that are sorted. Quantiles of this many evenly spaced samples scatter
/// by less than a percent.
const MOST: usize = 20_000;

/// Defines how quantiles are computed, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    format!(
        "A quantile *p* of *n* sorted values is the one at `p (n - 1)`, counted from 0, rounded to the nearest, halves up; a median has *p* = 0.5. Of more than {MOST} \
         values only each *k*-th counts, from the first on, *k* being *n* over {MOST} rounded up.\n"
    )
}

/// Returns the quantile `part` (0 to 1) of the values; for long signals, the quantile of evenly
/// spaced samples. `None` if there are no values.
pub(crate) fn quantile(part: f64, len: usize, value: impl Fn(usize) -> f64) -> Option<f64> {
    let mut values: Vec<f64> = (0..len).step_by(len.div_ceil(MOST).max(1)).map(value).collect();
    let last = values.len().checked_sub(1)?;
    let at = (part * last as f64).round() as usize;
    Some(*values.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// Returns the median of a list; `None` if it is empty.
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    quantile(0.5, values.len(), |at| values[at])
}
