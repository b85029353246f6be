//! The beta density over a logarithmic frequency axis (paper, Spectral beta).

use crate::Band;

/// Position of `f_hz` on the band's normalised logarithmic axis, `ln(f / low) / ln(high / low)`: 0
/// at the lower edge, 1 at the upper edge, and outside `[0, 1]` for frequencies outside the band.
///
/// ```
/// use htex_dsp::{Band, beta::log_unit};
/// assert_eq!(log_unit(20.0, Band::TACTILE), 0.0);
/// assert_eq!(log_unit(1000.0, Band::TACTILE), 1.0);
/// ```
pub fn log_unit(f_hz: f64, band: Band) -> f64 {
    LogAxis::new(band).unit_at(f_hz)
}

/// The axis of [`log_unit`], precomputed for one band.
#[derive(Debug, Clone, Copy)]
pub struct LogAxis {
    low_hz: f64,
    log_ratio: f64,
}

impl LogAxis {
    pub fn new(band: Band) -> Self {
        Self { low_hz: band.low_hz, log_ratio: libm::log(band.high_hz / band.low_hz) }
    }

    /// Returns the position of `f_hz` on the axis, as [`log_unit`] does.
    pub fn unit_at(&self, f_hz: f64) -> f64 {
        libm::log(f_hz / self.low_hz) / self.log_ratio
    }
}

/// Density of the beta distribution, `u^(α-1) (1-u)^(β-1) / B(α, β)`, 0 outside `[0, 1]`.
///
/// At an edge, the value is the limit: 0 if the parameter for this edge (α at the lower edge, β at
/// the upper edge) is above 1, finite if it is exactly 1, and +∞ if it is below 1. The relative
/// error is about 1e-13 for parameters below 100, and 1e-8 at a million.
///
/// ```
/// use htex_dsp::beta::BetaDensity;
/// let density = BetaDensity::new(2.0, 2.0);
/// assert!((density.density_at(0.5) - 1.5).abs() < 1e-12);
/// assert_eq!(density.density_at(0.0), 0.0);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct BetaDensity {
    alpha: f64,
    beta: f64,
    /// `ln B(α, β)`.
    log_scale: f64,
}

impl BetaDensity {
    /// Makes the density. If `alpha` and `beta` are not positive and finite, the density is NaN
    /// everywhere.
    pub fn new(alpha: f64, beta: f64) -> Self {
        let valid = [alpha, beta].iter().all(|p| *p > 0.0 && p.is_finite());
        // The scale is computed in logarithms, because the gamma function overflows from 171 on.
        let log_scale = if valid {
            libm::lgamma(alpha) + libm::lgamma(beta) - libm::lgamma(alpha + beta)
        } else {
            f64::NAN
        };
        Self { alpha, beta, log_scale }
    }

    pub fn density_at(&self, u: f64) -> f64 {
        if self.log_scale.is_nan() || u.is_nan() {
            return f64::NAN;
        }
        if !(0.0..=1.0).contains(&u) {
            return 0.0;
        }
        let left = times_log(self.alpha - 1.0, libm::log(u));
        // `log(1 - u)` would lose the digits of a small `u`.
        let right = times_log(self.beta - 1.0, libm::log1p(-u));
        libm::exp(left + right - self.log_scale)
    }

    /// Writes the density at several points; for each point, the caller passes `ln u` and `ln (1 -
    /// u)`, which must be finite. The result is as accurate as the results of
    /// [`exponentials`](crate::exponential::exponentials). The shortest slice determines the number
    /// of points.
    pub fn fill(&self, log: &[f64], log_rest: &[f64], density: &mut [f64]) {
        let (left, right) = (self.alpha - 1.0, self.beta - 1.0);
        for ((d, log), log_rest) in density.iter_mut().zip(log).zip(log_rest) {
            *d = left * log + right * log_rest - self.log_scale;
        }
        crate::exponential::exponentials(density);
    }
}

/// Returns `factor * log`, and 0 for a factor of 0, even if the logarithm is -∞.
fn times_log(factor: f64, log: f64) -> f64 {
    if factor == 0.0 { 0.0 } else { factor * log }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn density(u: f64, alpha: f64, beta: f64) -> f64 {
        BetaDensity::new(alpha, beta).density_at(u)
    }

    #[test]
    fn edges_take_the_limit() {
        assert_eq!(density(0.0, 2.0, 3.0), 0.0);
        assert_eq!(density(1.0, 2.0, 3.0), 0.0);
        assert_eq!(density(0.0, 0.5, 3.0), f64::INFINITY);
        assert_eq!(density(1.0, 2.0, 0.5), f64::INFINITY);
        assert!((density(0.0, 1.0, 3.0) - 3.0).abs() < 1e-13);
        assert!((density(1.0, 4.0, 1.0) - 4.0).abs() < 1e-13);
        assert_eq!(density(1.5, 1.0, 1.0), 0.0);
        assert!(density(0.5, 0.0, 1.0).is_nan());
    }
}
