//! Paired comparisons and corrections for their number.

use crate::StatisticsError;
use crate::describe::{mean, negligible, sum_of_squares};
use crate::distributions::{t_critical, t_two_sided};
use crate::table::check_finite;

const TEST: &str = "a paired t-test";

/// A paired t-test with its effect sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairedT {
    /// Mean of the differences, first less second.
    pub mean_difference: f64,
    /// Student's t.
    pub t: f64,
    /// Degrees of freedom: participants less 1.
    pub df: usize,
    /// Two-sided p-value.
    pub p: f64,
    /// Confidence interval of the mean difference, 95 %.
    pub ci95: [f64; 2],
    /// Cohen's d_z: the mean difference by the standard deviation of the differences.
    pub cohen_dz: f64,
    /// Cohen's d_av: the mean difference by the root mean square of both standard deviations; `None` if both are 0.
    pub cohen_d_av: Option<f64>,
    /// Hedges' g: d_av times 1 - 3 / (4 (2 n) - 9), as pingouin corrects it.
    pub hedges_g: Option<f64>,
}

/// Compares two conditions, given by participant in the same order.
///
/// # Errors
/// The lengths differ, there are fewer than two participants, a value is not finite, or all differences are equal.
///
/// ```
/// let test = htex_statistics::paired_t(&[3.0, 4.0, 5.0], &[2.0, 2.0, 4.0])?;
/// assert!((test.t - 4.0).abs() < 1e-12);
/// # Ok::<(), htex_statistics::StatisticsError>(())
/// ```
pub fn paired_t(a: &[f64], b: &[f64]) -> Result<PairedT, StatisticsError> {
    let count = a.len();
    if b.len() != count {
        return Err(StatisticsError::Shape {
            found: count + b.len(),
            participants: count,
            levels: 2,
        });
    }
    if count < 2 {
        return Err(StatisticsError::TooFewParticipants {
            test: TEST,
            found: count,
            needed: 2,
        });
    }
    check_finite(a)?;
    check_finite(b)?;
    let differences: Vec<f64> = a.iter().zip(b).map(|(x, y)| x - y).collect();
    let squares = sum_of_squares(&differences);
    let largest = a
        .iter()
        .chain(b)
        .fold(0.0, |most: f64, v| most.max(v.abs()));
    if negligible(squares, largest, count) {
        return Err(StatisticsError::NoErrorVariance { test: TEST });
    }
    Ok(of_differences(a, b, mean(&differences), squares))
}

fn of_differences(a: &[f64], b: &[f64], mean_difference: f64, squares: f64) -> PairedT {
    let (n, df) = (a.len() as f64, a.len() - 1);
    let sd = libm::sqrt(squares / df as f64);
    let error = sd / libm::sqrt(n);
    let t = mean_difference / error;
    let half = t_critical(0.05, df as f64) * error;
    let average = libm::sqrt((sum_of_squares(a) + sum_of_squares(b)) / (2.0 * df as f64));
    let cohen_d_av = (average > 0.0).then_some(mean_difference / average);
    let correction = 1.0 - 3.0 / (8.0 * n - 9.0);
    PairedT {
        mean_difference,
        t,
        df,
        p: t_two_sided(t, df as f64),
        ci95: [mean_difference - half, mean_difference + half],
        cohen_dz: mean_difference / sd,
        cohen_d_av,
        hedges_g: cohen_d_av.map(|d| d * correction),
    }
}

/// Multiplies each p-value by their number, up to 1.
pub fn bonferroni(p: &[f64]) -> Vec<f64> {
    let count = p.len() as f64;
    p.iter().map(|p| (p * count).min(1.0)).collect()
}

/// Holm's step-down correction (1979): never larger than Bonferroni's, with the same guarantee.
///
/// ```
/// assert_eq!(htex_statistics::holm(&[0.01, 0.04, 0.03]), [0.03, 0.06, 0.06]);
/// ```
pub fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|a, b| p[*a].total_cmp(&p[*b]));
    let mut corrected = vec![0.0; p.len()];
    let mut largest: f64 = 0.0;
    for (rank, index) in order.into_iter().enumerate() {
        largest = largest.max((p[index] * (p.len() - rank) as f64).min(1.0));
        corrected[index] = largest;
    }
    corrected
}
