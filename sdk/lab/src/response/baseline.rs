//! Finds a signal's level at rest and its noise, in a recording with short hits.

/// Ratio of the standard deviation of normal noise to its median absolute deviation.
const NORMAL: f64 = 1.482_602_218_505_602;

/// A signal's level at rest and its noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Baseline {
    /// The median.
    pub(crate) level: f64,
    /// RMS of the noise, from the median absolute deviation. Hits do not influence it as long as
    /// they fill less than half of the recording.
    pub(crate) noise: f64,
    /// Largest distance from the level.
    pub(crate) largest: f64,
}

impl Baseline {
    /// Finds the baseline of a signal. Without samples, all values are zero.
    pub(crate) fn of(values: &[f64]) -> Self {
        let level = median(values.to_vec());
        let deviations: Vec<f64> = values.iter().map(|value| (value - level).abs()).collect();
        let largest = deviations.iter().copied().fold(0.0, f64::max);
        let noise = NORMAL * median(deviations);
        Self { level, noise, largest }
    }
}

/// The upper median.
fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
