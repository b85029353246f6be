//! Estimators of a response from averaged spectra.
//!
//! The result of total least squares (`Hv`) depends on the units of the channels. To remove this
//! dependence, each channel is first divided by the root of its power in the band.

use std::fmt;

use num_complex::Complex;
use serde::{Deserialize, Serialize};

/// An estimator of a frequency response. An estimator computes the response from the auto spectra
/// `Gxx` (input) and `Gyy` (output) and from the cross spectrum `Gxy`. All three estimators have
/// the phase of `Gxy`, and `|H1| <= |Hv| <= |H2|`. Without noise, the three estimators are equal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Estimator {
    /// `Gxy / Gxx`. Noise in the output does not bias this estimate; noise in the input makes it
    /// too low (Bendat & Piersol, chapter 6).
    H1,
    /// `Gyy / Gyx`. Noise in the input does not bias this estimate; noise in the output makes it
    /// too high.
    H2,
    /// Total least squares (Rocklin, Crowley and Vold, 1985), for noise in both channels. Each
    /// channel is first divided by the root of its power in the band, so that the result does not
    /// depend on units. The estimate is unbiased if both channels have white noise, and if the
    /// ratio of noise power to signal power is the same in both channels.
    Hv,
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::H1 => "H1",
            Self::H2 => "H2",
            Self::Hv => "Hv",
        })
    }
}

/// The averaged spectra at one frequency, and the power of both channels in the band.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bin {
    pub(crate) gxx: f64,
    pub(crate) gyy: f64,
    pub(crate) gxy: Complex<f64>,
    pub(crate) input_power: f64,
    pub(crate) output_power: f64,
}

impl Bin {
    /// Returns the magnitude of the response. It is 0 if the estimator is not defined, for example
    /// without any input.
    pub(crate) fn magnitude(&self, estimator: Estimator) -> f64 {
        let cross = self.gxy.norm_sqr().sqrt();
        let magnitude = match estimator {
            Estimator::H1 => cross / self.gxx,
            Estimator::H2 => self.gyy / cross,
            Estimator::Hv => self.total_least_squares(cross),
        };
        if magnitude.is_finite() { magnitude } else { 0.0 }
    }

    /// Returns the slope of the principal axis of the scaled spectral matrix:
    /// `(b - a + sqrt((b - a)² + 4 c²)) / 2c`.
    fn total_least_squares(&self, cross: f64) -> f64 {
        let (x, y) = (self.input_power, self.output_power);
        let unit = (y / x).sqrt();
        let (a, b, c) = (self.gxx / x, self.gyy / y, cross / (x * y).sqrt());
        let root = libm::hypot(b - a, 2.0 * c);
        // Both forms are mathematically equal. The chosen form adds instead of subtracting, so it
        // loses no digits.
        let slope = if b >= a { (b - a + root) / (2.0 * c) } else { 2.0 * c / (a - b + root) };
        slope * unit
    }

    /// Returns the phase of the response, radians.
    pub(crate) fn phase_rad(&self) -> f64 {
        libm::atan2(self.gxy.im, self.gxy.re)
    }

    /// Returns the coherence `|Gxy|² / (Gxx Gyy)`, 0 to 1: the part of the output's power that the
    /// input explains. It is 0 without power.
    pub(crate) fn coherence(&self) -> f64 {
        let power = self.gxx * self.gyy;
        if power > 0.0 { (self.gxy.norm_sqr() / power).clamp(0.0, 1.0) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// H1 <= Hv <= H2 for every spectral matrix, whatever the units. Without noise, all three
        /// equal the gain.
        #[test]
        fn estimators_are_ordered(
            gxx in 1e-6..1e6_f64, gyy in 1e-6..1e6_f64, coherence in 0.01..1.0_f64, phase in -3.0..3.0_f64,
            input_power in 1e-3..1e3_f64, output_power in 1e-3..1e3_f64,
        ) {
            let cross = (coherence * gxx * gyy).sqrt();
            let gxy = Complex::new(cross * libm::cos(phase), cross * libm::sin(phase));
            let bin = Bin { gxx, gyy, gxy, input_power, output_power };
            let [h1, hv, h2] = [Estimator::H1, Estimator::Hv, Estimator::H2].map(|e| bin.magnitude(e));
            prop_assert!(h1 <= hv * (1.0 + 1e-12) && hv <= h2 * (1.0 + 1e-12), "{h1} {hv} {h2}");
            prop_assert!((h1 / h2 - coherence).abs() < 1e-12 && (bin.coherence() - coherence).abs() < 1e-12);
            prop_assert!((bin.phase_rad() - phase).abs() < 1e-9);
        }
    }

    #[test]
    fn bins_without_power_have_no_response() {
        let bin =
            Bin { gxx: 0.0, gyy: 0.0, gxy: Complex::ZERO, input_power: 1.0, output_power: 1.0 };
        for estimator in [Estimator::H1, Estimator::H2, Estimator::Hv] {
            assert_eq!(bin.magnitude(estimator), 0.0);
        }
        assert_eq!(bin.coherence(), 0.0);
    }
}
