//! Sphericity: whether all differences between conditions have the same variance, and what to do if not.

use crate::StatisticsError;
use crate::distributions::chi_squared_sf;
use crate::linear::log_determinant;

/// Mauchly's test of sphericity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphericity {
    /// Mauchly's W, 0 to 1; 1 is sphericity.
    pub w: f64,
    /// The statistic that is compared with chi-squared.
    pub chi2: f64,
    /// Degrees of freedom.
    pub df: f64,
    /// p-value with the second term of Box's expansion, as in R.
    pub p: f64,
    /// The same as pingouin 0.7 computes it: with the number of conditions in place of the contrasts in one term.
    pub p_pingouin: f64,
}

/// Greenhouse and Geisser's epsilon: (tr S)^2 / (df tr S^2) of the contrasts' covariance S, 1 / df to 1.
///
/// `products` are a multiple of S.
pub(crate) fn greenhouse_geisser(products: &[Vec<f64>]) -> f64 {
    let df = products.len() as f64;
    let trace = trace(products);
    let squares: f64 = products.iter().flatten().map(|s| s * s).sum();
    (trace * trace / (df * squares)).clamp(1.0 / df, 1.0)
}

/// Huynh and Feldt's epsilon for one group (1976, equation 4): (n df e - 2) / (df (n - 1 - df e)), at most 1.
pub(crate) fn huynh_feldt(eps_gg: f64, df: f64, participants: f64) -> f64 {
    let below = df * (participants - 1.0 - df * eps_gg);
    if below <= 0.0 {
        return 1.0;
    }
    ((participants * df * eps_gg - 2.0) / below).clamp(eps_gg, 1.0)
}

/// Mauchly's test (1940), with two terms of Box's expansion for the p-value (Anderson 2003, section 10.7.4).
pub(crate) fn mauchly(
    products: &[Vec<f64>],
    participants: usize,
) -> Result<Sphericity, StatisticsError> {
    let size = products.len();
    if size < 2 {
        return Err(StatisticsError::SphericityTrivial);
    }
    let undefined = StatisticsError::SphericityUndefined {
        participants,
        differences: size,
    };
    let determinant = (participants > size).then(|| log_determinant(products));
    let Some(log_determinant) = determinant.flatten() else {
        return Err(undefined);
    };
    let d = size as f64;
    let log_w = (log_determinant - d * libm::log(trace(products) / d)).min(0.0);
    let n = participants as f64 - 1.0;
    let factor = 1.0 - (2.0 * d * d + d + 2.0) / (6.0 * d * n);
    let chi2 = -n * factor * log_w;
    let df = d * (d + 1.0) / 2.0 - 1.0;
    let tails = [chi_squared_sf(chi2, df), chi_squared_sf(chi2, df + 4.0)];
    let p = |last: f64| {
        let scale = 288.0 * (d * n * factor) * (d * n * factor);
        let cubic = 2.0 * d * d * d + 6.0 * d * d + 3.0 * last + 2.0;
        let second = (d + 2.0) * (d - 1.0) * (d - 2.0) * cubic / scale;
        tails[0] + second * (tails[1] - tails[0])
    };
    if factor <= 0.0 || !chi2.is_finite() {
        return Err(undefined);
    }
    Ok(Sphericity {
        w: libm::exp(log_w),
        chi2,
        df,
        p: p(d).clamp(0.0, 1.0),
        p_pingouin: p(d + 1.0).clamp(0.0, 1.0),
    })
}

fn trace(matrix: &[Vec<f64>]) -> f64 {
    (0..matrix.len()).map(|k| matrix[k][k]).sum()
}
