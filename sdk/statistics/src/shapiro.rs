//! Shapiro and Wilk's test of normality.

use crate::StatisticsError;
use crate::describe::{is_constant, require, sum_of_squares};
use crate::distributions::{normal_cdf, normal_quantile};
use crate::normality::{Test, polynomial, sorted};

const TEST: &str = "the Shapiro\u{2013}Wilk test";
const LIMIT: usize = 5000;

/// Shapiro and Wilk's test of `values`, by Royston's approximation (1995, algorithm AS R94).
///
/// ```
/// let test = htex_statistics::shapiro_wilk(&[148.0, 154.0, 158.0, 160.0, 161.0, 162.0, 166.0, 170.0, 182.0, 195.0, 236.0])?;
/// assert!((test.statistic - 0.7888).abs() < 1e-3 && (test.p - 0.0067).abs() < 1e-3);
/// # Ok::<(), htex_statistics::StatisticsError>(())
/// ```
///
/// # Errors
/// There are fewer than 3 or more than 5000 values, one is not finite, or all are equal.
pub fn shapiro_wilk(values: &[f64]) -> Result<Test, StatisticsError> {
    require(TEST, values, 3)?;
    let found = values.len();
    if found > LIMIT {
        return Err(StatisticsError::TooManyValues {
            test: TEST,
            found,
            limit: LIMIT,
        });
    }
    if is_constant(values) {
        return Err(StatisticsError::Constant { test: TEST });
    }
    let sorted = sorted(values);
    let weights = weights(found);
    let spread = |(i, w): (usize, &f64)| w * (sorted[found - 1 - i] - sorted[i]);
    let sum: f64 = weights.iter().enumerate().map(spread).sum();
    let w = (sum * sum / sum_of_squares(&sorted)).min(1.0);
    Ok(Test {
        statistic: w,
        p: p_value(w, found),
    })
}

/// Returns the weights of the largest less the smallest value, the second largest less the second smallest, and so on.
fn weights(n: usize) -> Vec<f64> {
    if n == 3 {
        return vec![std::f64::consts::FRAC_1_SQRT_2];
    }
    let count = n as f64;
    let score = |i: usize| -normal_quantile((i as f64 + 0.625) / (count + 0.25));
    let scores: Vec<f64> = (0..n / 2).map(score).collect();
    let squares = 2.0 * scores.iter().map(|m| m * m).sum::<f64>();
    let (norm, u) = (libm::sqrt(squares), 1.0 / libm::sqrt(count));
    let corrections = [
        [0.0, 0.221157, -0.147981, -2.07119, 4.434685, -2.706056],
        [0.0, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633],
    ];
    let corrected = if n > 5 { 2 } else { 1 };
    let first: Vec<f64> = (0..corrected)
        .map(|i| scores[i] / norm + polynomial(&corrections[i], u))
        .collect();
    let rest = |all: f64, taken: &[f64]| all - 2.0 * taken.iter().map(|v| v * v).sum::<f64>();
    let scale = libm::sqrt(rest(squares, &scores[..corrected]) / rest(1.0, &first));
    let others = scores[corrected..].iter().map(|m| m / scale);
    first.iter().copied().chain(others).collect()
}

fn p_value(w: f64, n: usize) -> f64 {
    let count = n as f64;
    if n == 3 {
        // 1.0472 is asin(sqrt(3/4)): W of three values is at least 3/4.
        let angle = libm::asin(libm::sqrt(w)) - std::f64::consts::FRAC_PI_3;
        return (6.0 / std::f64::consts::PI * angle).clamp(0.0, 1.0);
    }
    let mut y = libm::log((1.0 - w).max(1e-19));
    let (mean, log_sd) = if n <= 11 {
        let gamma = polynomial(&[-2.273, 0.459], count);
        if y >= gamma {
            return 0.0;
        }
        y = -libm::log(gamma - y);
        (
            polynomial(&[0.544, -0.39978, 0.025054, -6.714e-4], count),
            polynomial(&[1.3822, -0.77857, 0.062767, -0.0020322], count),
        )
    } else {
        let x = libm::log(count);
        (
            polynomial(&[-1.5861, -0.31082, -0.083751, 0.0038915], x),
            polynomial(&[-0.4803, -0.082676, 0.0030302], x),
        )
    };
    normal_cdf((mean - y) / libm::exp(log_sd))
}
