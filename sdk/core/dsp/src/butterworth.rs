//! Butterworth low-pass and high-pass filters of order 1 to 20: analogue magnitudes, and digital
//! second-order sections. The paper (Spectral slope) uses a high-pass filter and a low-pass filter,
//! but does not name their family.
//!
//! The digital design is the bilinear transform with a prewarped cut-off, as in
//! `scipy.signal.butter(..., output="sos")`. At the cut-off the magnitude is exactly 1/√2.

use core::f64::consts::PI;
use core::ops::Deref;

use crate::biquad::Biquad;

/// Highest order of a filter: its slope of 400 dB per decade exceeds the dynamic range of a
/// spectrum.
pub const MAX_ORDER: usize = 20;

/// The second-order sections of one filter, lowest Q first; dereferences to a slice. Does not
/// allocate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sections {
    sections: [Biquad; MAX_ORDER / 2],
    len: usize,
}

impl Deref for Sections {
    type Target = [Biquad];

    fn deref(&self) -> &[Biquad] {
        &self.sections[..self.len]
    }
}

/// Pass band of a filter.
#[derive(Clone, Copy)]
pub(crate) enum PassKind {
    LowPass,
    HighPass,
}

/// Returns low-pass sections with cut-off `fc_hz` at the sample rate `rate_hz`.
///
/// Returns `None` if the order is not from 1 to [`MAX_ORDER`], or if the cut-off is not strictly
/// between 0 and the Nyquist frequency `rate_hz / 2`.
pub fn low_pass(order: usize, fc_hz: f64, rate_hz: f64) -> Option<Sections> {
    design(PassKind::LowPass, order, fc_hz, rate_hz)
}

/// Returns high-pass sections. The arguments are the same as for [`low_pass`], and the result is
/// `None` in the same cases.
pub fn high_pass(order: usize, fc_hz: f64, rate_hz: f64) -> Option<Sections> {
    design(PassKind::HighPass, order, fc_hz, rate_hz)
}

/// Returns the magnitude `|H|` of an analogue low-pass of any positive order, at the frequency
/// `ratio` times its cut-off: `1 / sqrt(1 + ratio^(2 order))`. An analogue high-pass has this
/// magnitude at the frequency `1 / ratio` times its cut-off.
///
/// ```
/// use htex_dsp::butterworth::analog_low_pass_magnitude;
/// assert!((analog_low_pass_magnitude(1.0, 2.5) - 0.5_f64.sqrt()).abs() < 1e-15);
/// ```
pub fn analog_low_pass_magnitude(ratio: f64, order: f64) -> f64 {
    1.0 / crate::root::sqrt(1.0 + libm::pow(ratio, 2.0 * order))
}

fn design(kind: PassKind, order: usize, fc_hz: f64, rate_hz: f64) -> Option<Sections> {
    if !(1..=MAX_ORDER).contains(&order) || !in_range(fc_hz, rate_hz) {
        return None;
    }
    let omega = 2.0 * PI * fc_hz / rate_hz;
    let mut sections = [Biquad::IDENTITY; MAX_ORDER / 2];
    let mut len = 0;
    if order % 2 == 1 {
        sections[0] = first_order(kind, omega);
        len = 1;
    }
    for pair in 0..order / 2 {
        // Poles at angles π/2 ± (2k + 1)π/(2n) from the imaginary axis; 1/(2Q) is the cosine of a
        // pole's angle to the negative real axis. The largest Q (k = 0) comes last.
        let k = order / 2 - 1 - pair;
        let half_inverse_q = crate::trig::sin(PI * (2 * k + 1) as f64 / (2 * order) as f64);
        sections[len] = second_order(kind, omega, half_inverse_q);
        len += 1;
    }
    Some(Sections { sections, len })
}

/// Whether an edge lies strictly between 0 and the Nyquist frequency.
pub(crate) fn in_range(edge_hz: f64, rate_hz: f64) -> bool {
    edge_hz > 0.0 && edge_hz < rate_hz / 2.0 && rate_hz.is_finite()
}

/// Bilinear transform of `1 / (s + 1)` or `s / (s + 1)`. It uses the sine and cosine of half the
/// cut-off angle, because the usual tangent overflows near the Nyquist frequency.
fn first_order(kind: PassKind, omega: f64) -> Biquad {
    let (sine, cosine) = crate::trig::sincos(omega / 2.0);
    let scale = 1.0 / (sine + cosine);
    let (b0, b1) = match kind {
        PassKind::LowPass => (sine * scale, sine * scale),
        PassKind::HighPass => (cosine * scale, -cosine * scale),
    };
    Biquad { b0, b1, b2: 0.0, a1: (sine - cosine) * scale, a2: 0.0 }
}

/// Bilinear transform of `1 / (s² + s/Q + 1)` or `s² / (s² + s/Q + 1)`.
pub(crate) fn second_order(kind: PassKind, omega: f64, half_inverse_q: f64) -> Biquad {
    let alpha = crate::trig::sin(omega) * half_inverse_q;
    let scale = 1.0 / (1.0 + alpha);
    let (sine, cosine) = crate::trig::sincos(omega / 2.0);
    let (b0, sign) = match kind {
        // The usual form, `(1 - cos) / 2`, would cancel for a low cut-off.
        PassKind::LowPass => (sine * sine * scale, 1.0),
        PassKind::HighPass => (cosine * cosine * scale, -1.0),
    };
    Biquad {
        b0,
        b1: 2.0 * sign * b0,
        b2: b0,
        a1: -2.0 * crate::trig::cos(omega) * scale,
        a2: (1.0 - alpha) * scale,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::biquad::Cascade;

    #[test]
    fn half_power_at_the_cutoff_and_stable_for_every_order() {
        for order in 1..=MAX_ORDER {
            for fc in [1.0, 20.0, 450.0, 5000.0, 9999.0, 9999.999] {
                for design in [low_pass, high_pass] {
                    let sections = design(order, fc, 20_000.0).unwrap();
                    assert_eq!(sections.len(), order.div_ceil(2));
                    assert!(sections.iter().all(Biquad::is_stable), "{order} {fc}");
                    let magnitude = Cascade::new(&sections).magnitude(fc, 20_000.0);
                    let error = magnitude * core::f64::consts::SQRT_2 - 1.0;
                    // A thousandth of a hertz below Nyquist, f64 coefficients cannot resolve the
                    // poles.
                    assert!(fc > 9999.5 || error.abs() < 1e-6, "{order} {fc} {error}");
                }
            }
        }
    }

    #[test]
    fn orders_and_cutoffs_out_of_range_are_refused() {
        assert!(low_pass(0, 100.0, 2000.0).is_none());
        assert!(low_pass(21, 100.0, 2000.0).is_none());
        assert!(low_pass(2, 1000.0, 2000.0).is_none());
        assert!(high_pass(2, 0.0, 2000.0).is_none());
        assert!(high_pass(2, f64::NAN, 2000.0).is_none());
        assert!(high_pass(2, 100.0, f64::INFINITY).is_none());
    }
}
