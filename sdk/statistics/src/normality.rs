//! Tests of normality by the largest distance between distributions.

use crate::StatisticsError;
use crate::describe::{is_constant, require, z_scores};
use crate::kolmogorov::{distance_from_normal, kolmogorov_sf};

/// A statistic and its p-value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Test {
    /// The statistic: D of Kolmogorov, or W of Shapiro and Wilk.
    pub statistic: f64,
    /// p-value.
    pub p: f64,
}

/// Kolmogorov and Smirnov's test of `values` against the standard normal.
///
/// For values that were standardised by their own mean and deviation the p-value is too large, since the normal was fitted to them:
/// [`lilliefors`] corrects for that.
///
/// # Errors
/// There is no value, or one is not finite.
pub fn kolmogorov_smirnov(values: &[f64]) -> Result<Test, StatisticsError> {
    require("the Kolmogorov\u{2013}Smirnov test", values, 1)?;
    let statistic = distance_from_normal(&sorted(values));
    Ok(Test {
        statistic,
        p: kolmogorov_sf(values.len(), statistic),
    })
}

/// Lilliefors' test of `values` against the normal with their own mean and deviation.
///
/// p-values by Dallal and Wilkinson (1986) up to 0.1, above by Stephens' modified statistic (1974), as in R's `nortest`. They are
/// approximations to about 0.01.
///
/// # Errors
/// There are fewer than 5 values, one is not finite, or all are equal.
pub fn lilliefors(values: &[f64]) -> Result<Test, StatisticsError> {
    const TEST: &str = "Lilliefors' test";
    require(TEST, values, 5)?;
    if is_constant(values) {
        return Err(StatisticsError::Constant { test: TEST });
    }
    let statistic = distance_from_normal(&sorted(&z_scores(values)?));
    Ok(Test {
        statistic,
        p: lilliefors_p(values.len() as f64, statistic),
    })
}

fn lilliefors_p(n: f64, d: f64) -> f64 {
    let (scaled, m) = match n {
        _ if n > 100.0 => (d * libm::pow(n / 100.0, 0.49), 100.0),
        _ => (d, n),
    };
    let p = libm::exp(
        -7.01256 * scaled * scaled * (m + 2.78019) + 2.99587 * scaled * libm::sqrt(m + 2.78019)
            - 0.122119
            + 0.974598 / libm::sqrt(m)
            + 1.67997 / m,
    );
    if p <= 0.1 { p } else { stephens_p(n, d) }
}

fn stephens_p(n: f64, d: f64) -> f64 {
    let root = libm::sqrt(n);
    let x = (root - 0.01 + 0.85 / root) * d;
    let p = match x {
        _ if x <= 0.302 => 1.0,
        _ if x <= 0.5 => polynomial(&[2.76773, -19.828315, 80.709644, -138.55152, 81.218052], x),
        _ if x <= 0.9 => polynomial(
            &[-4.901232, 40.662806, -97.490286, 94.029866, -32.355711],
            x,
        ),
        _ if x <= 1.31 => polynomial(&[6.198765, -19.558097, 23.186922, -12.234627, 2.423045], x),
        _ => 0.0,
    };
    p.clamp(0.0, 1.0)
}

/// Evaluates a polynomial whose coefficients begin with the constant.
pub(crate) fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

pub(crate) fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}
