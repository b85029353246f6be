//! Quantiles of long signals.

/// Largest number of values that are sorted. If quantiles are computed from this many evenly spaced
/// samples, they scatter by less than a percent.
const MOST: usize = 20_000;

/// Defines how quantiles are computed, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    format!(
        "A quantile *p* of *n* sorted values is the one at `p (n - 1)`, counted from 0, rounded to the nearest, halves up; a median has *p* = 0.5. Of more than {MOST} \
         values only each *k*-th counts, from the first on, *k* being *n* over {MOST} rounded up.\n"
    )
}

/// Returns the quantile `part` (0 to 1) of the values. For long signals, computes it only from
/// evenly spaced samples. `None` if there are no values.
pub(crate) fn quantile(part: f64, len: usize, value: impl Fn(usize) -> f64) -> Option<f64> {
    let places = (0..len).step_by(len.div_ceil(MOST).max(1));
    let mut keys: Vec<i64> = places.map(|at| key(value(at).to_bits() as i64)).collect();
    let last = keys.len().checked_sub(1)?;
    let at = (part * last as f64).round() as usize;
    Some(f64::from_bits(key(*keys.select_nth_unstable(at).1) as u64))
}

/// Maps the bits of a number to an integer in the order of [`f64::total_cmp`], and back. Comparing
/// integers takes half the time.
fn key(bits: i64) -> i64 {
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

/// Returns the median of a list; `None` if it is empty.
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    quantile(0.5, values.len(), |at| values[at])
}
