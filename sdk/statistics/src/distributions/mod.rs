//! Distribution functions: normal, Student's t, chi-squared, F and noncentral F.
//!
//! Upper tails are computed as such, not as `1 - cdf`, so that small p-values keep their digits.

mod beta;
mod gamma;
mod noncentral;

pub use noncentral::noncentral_f_sf;

/// Distribution function of the standard normal.
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

/// Quantile of the standard normal for a probability between 0 and 1, both excluded.
pub fn normal_quantile(p: f64) -> f64 {
    if p > 0.5 {
        return -normal_quantile(1.0 - p);
    }
    -bisect(0.0, 40.0, |z| normal_cdf(-z) > p)
}

/// Two-sided p-value of Student's t: the probability of a value at least as far from 0.
///
/// ```
/// // The 97.5 % quantile with 13 degrees of freedom is 2.160.
/// assert!((htex_statistics::distributions::t_two_sided(2.160, 13.0) - 0.05).abs() < 1e-4);
/// ```
pub fn t_two_sided(t: f64, df: f64) -> f64 {
    let squared = t * t;
    beta::tails(df / 2.0, 0.5, df / (df + squared), squared / (df + squared)).0
}

/// The value that Student's t exceeds in size with probability `p`, between 0 and 1, both excluded.
pub fn t_critical(p: f64, df: f64) -> f64 {
    bisect(0.0, 1e300, |t| t_two_sided(t, df) > p)
}

/// Upper tail of chi-squared.
pub fn chi_squared_sf(x: f64, df: f64) -> f64 {
    gamma::upper(df / 2.0, x / 2.0)
}

/// Upper tail of F.
pub fn f_sf(f: f64, df: [f64; 2]) -> f64 {
    let (x, y) = beta_point(f, df);
    beta::tails(df[0] / 2.0, df[1] / 2.0, x, y).1
}

/// The value that F exceeds with probability `p`, between 0 and 1, both excluded.
pub fn f_critical(p: f64, df: [f64; 2]) -> f64 {
    bisect(0.0, 1e300, |f| f_sf(f, df) > p)
}

/// Returns the argument of the incomplete beta function that belongs to `f`, and its distance from 1.
fn beta_point(f: f64, df: [f64; 2]) -> (f64, f64) {
    let ratio = f.max(0.0) * df[0] / df[1];
    if ratio.is_finite() {
        (ratio / (1.0 + ratio), 1.0 / (1.0 + ratio))
    } else {
        (1.0, 0.0)
    }
}

/// Returns the point between `low` and `high` up to which `below` holds, to the last digits of a double.
fn bisect(low: f64, high: f64, below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    // First by ratio, so that wide ranges take few steps.
    while high > 4.0 * low.max(1e-3) {
        let middle = libm::sqrt(low.max(1e-3)) * libm::sqrt(high);
        if below(middle) {
            low = middle
        } else {
            high = middle
        }
    }
    for _ in 0..80 {
        let middle = low + (high - low) / 2.0;
        if below(middle) {
            low = middle
        } else {
            high = middle
        }
    }
    low + (high - low) / 2.0
}
