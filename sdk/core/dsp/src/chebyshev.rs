//! Chebyshev filters of type I as digital second-order sections.

use alloc::vec::Vec;

use crate::biquad::Biquad;
use crate::butterworth::{PassKind, in_range, second_order};

/// Returns the sections of a Chebyshev filter of type I, at the sample rate `rate_hz` (bilinear
/// transform, prewarped edge). In the pass band the magnitude is within half of `ripple_db` of 1;
/// at `edge_hz` it is 3 dB down. `order` must be even, and `ripple_db` in (0, 3).
///
/// `None` if the edge is not strictly between 0 and the Nyquist frequency `rate_hz / 2`.
pub(crate) fn chebyshev(
    kind: PassKind,
    order: usize,
    ripple_db: f64,
    edge_hz: f64,
    rate_hz: f64,
) -> Option<Vec<Biquad>> {
    if !in_range(edge_hz, rate_hz) {
        return None;
    }
    let n = order as f64;
    let ripple = crate::root::sqrt(libm::pow(10.0, 0.1 * ripple_db) - 1.0);
    // Poles of an analogue low-pass whose ripple band ends at 1, scaled so that it is 3 dB down at
    // the edge.
    let spread = libm::asinh(1.0 / ripple) / n;
    let down = libm::cosh(libm::acosh(1.0 / ripple) / n);
    let tangent = crate::trig::tan(core::f64::consts::PI * edge_hz / rate_hz);
    let mut sections: Vec<Biquad> = (0..order / 2)
        .map(|k| {
            let (sine, cosine) =
                crate::trig::sincos(core::f64::consts::PI * (2 * k + 1) as f64 / (2.0 * n));
            let (real, imaginary) = (libm::sinh(spread) * sine, libm::cosh(spread) * cosine);
            let radius = libm::hypot(real, imaginary);
            let cut = match kind {
                PassKind::LowPass => tangent * radius / down,
                PassKind::HighPass => tangent * down / radius,
            };
            second_order(kind, 2.0 * libm::atan(cut), real / radius)
        })
        .collect();
    // Each section has magnitude 1 at the far end of the pass band. There the ripple is at its
    // minimum. A factor of half the ripple makes the ripple lie evenly around 1. The sections are
    // in series, so one of them can carry the factor for all.
    let middle = libm::pow(10.0, -ripple_db / 40.0);
    if let Some(section) = sections.first_mut() {
        section.b0 *= middle;
        section.b1 *= middle;
        section.b2 *= middle;
    }
    Some(sections)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::biquad::Cascade;

    /// The squared magnitude is `1 / (1 + ε² T_n²(f))`, at frequencies that the tangent of the
    /// bilinear transform has warped.
    #[test]
    fn the_magnitude_follows_the_chebyshev_polynomial() {
        let (order, ripple_db, rate_hz) = (4, 0.2, 4_000.0);
        for (kind, edge_hz) in [(PassKind::HighPass, 17.5), (PassKind::LowPass, 1_002.5)] {
            let sections = chebyshev(kind, order, ripple_db, edge_hz, rate_hz).unwrap();
            let filter = Cascade::new(&sections);
            let square = libm::pow(10.0, 0.1 * ripple_db) - 1.0;
            let down = libm::cosh(libm::acosh(1.0 / libm::sqrt(square)) / order as f64);
            let bent = |hz: f64| libm::tan(core::f64::consts::PI * hz / rate_hz);
            for hz in [2.0, 10.0, 17.5, 19.0, 25.0, 300.0, 900.0, 1_002.5, 1_500.0] {
                let x = match kind {
                    PassKind::LowPass => down * bent(hz) / bent(edge_hz),
                    PassKind::HighPass => down * bent(edge_hz) / bent(hz),
                };
                // T4.
                let polynomial = 8.0 * x * x * x * x - 8.0 * x * x + 1.0;
                let expected = libm::pow(10.0, 0.05 * ripple_db)
                    / libm::sqrt(1.0 + square * polynomial * polynomial);
                let ratio = filter.magnitude(hz, rate_hz)
                    / (expected * libm::pow(10.0, -0.025 * ripple_db));
                assert!((ratio - 1.0).abs() < 1e-9, "{hz}: {ratio}");
            }
        }
    }
}
