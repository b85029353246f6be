//! Descriptive statistics: means, deviations, correlation.

use crate::StatisticsError;
use crate::table::check_finite;

/// Mean and spread of some values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// Number of values.
    pub count: usize,
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation with n - 1; 0 for one value.
    pub sd: f64,
}

/// Returns mean and standard deviation (n - 1) of `values`.
///
/// # Errors
/// There is no value, or one is not finite.
pub fn summary(values: &[f64]) -> Result<Summary, StatisticsError> {
    require("a mean", values, 1)?;
    let mean = mean(values);
    let squares = sum_of_squares(values);
    let sd = libm::sqrt(squares / (values.len().max(2) - 1) as f64);
    Ok(Summary {
        count: values.len(),
        mean,
        sd,
    })
}

/// Returns `values` less their mean, divided by their standard deviation (n - 1).
///
/// # Errors
/// There are fewer than two values, one is not finite, or all are equal.
pub fn z_scores(values: &[f64]) -> Result<Vec<f64>, StatisticsError> {
    require("a z-score", values, 2)?;
    if is_constant(values) {
        return Err(StatisticsError::Constant { test: "a z-score" });
    }
    let Summary { mean, sd, .. } = summary(values)?;
    Ok(values.iter().map(|v| (v - mean) / sd).collect())
}

/// Returns Pearson's correlation of `a` and `b`, which have the same length.
///
/// # Errors
/// There are fewer than two pairs, a value is not finite, or all values of one side are equal.
pub fn pearson(a: &[f64], b: &[f64]) -> Result<f64, StatisticsError> {
    const TEST: &str = "a correlation";
    let count = a.len().min(b.len());
    let (a, b) = (&a[..count], &b[..count]);
    for values in [a, b] {
        require(TEST, values, 2)?;
        if is_constant(values) {
            return Err(StatisticsError::Constant { test: TEST });
        }
    }
    let (mean_a, mean_b) = (mean(a), mean(b));
    let product: f64 = a
        .iter()
        .zip(b)
        .map(|(x, y)| (x - mean_a) * (y - mean_b))
        .sum();
    let norm = libm::sqrt(sum_of_squares(a)) * libm::sqrt(sum_of_squares(b));
    Ok((product / norm).clamp(-1.0, 1.0))
}

/// Requires at least `needed` finite values.
pub(crate) fn require(
    test: &'static str,
    values: &[f64],
    needed: usize,
) -> Result<(), StatisticsError> {
    let found = values.len();
    if found < needed {
        return Err(StatisticsError::TooFewValues {
            test,
            found,
            needed,
        });
    }
    check_finite(values)
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Sum of squared differences from the mean.
pub(crate) fn sum_of_squares(values: &[f64]) -> f64 {
    let mean = mean(values);
    values.iter().map(|v| (v - mean) * (v - mean)).sum()
}

/// Whether values differ by no more than rounding.
pub(crate) fn is_constant(values: &[f64]) -> bool {
    let largest = values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    negligible(sum_of_squares(values), largest, values.len())
}

/// Whether a sum of `count` squares is no more than the rounding of values up to `largest`.
pub(crate) fn negligible(squares: f64, largest: f64, count: usize) -> bool {
    let rounding = largest * 1e-13;
    squares <= rounding * rounding * count as f64
}
