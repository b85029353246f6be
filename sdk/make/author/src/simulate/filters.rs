//! Filters of the simulated hand, skin and rig.

use std::f64::consts::PI;

use htex_dsp::biquad::Biquad;

/// Designs the filter `b2 s^2 + b1 s + b0` over `s^2 + s/q + 1` by the bilinear transform, exact at
/// `hz`. The unit of s is 2 pi `hz`.
fn analog(numerator: [f64; 3], q: f64, hz: f64, rate_hz: f64) -> Biquad {
    let c = 1.0 / libm::tan(PI * hz / rate_hz);
    let [b2, b1, b0] = numerator;
    let norm = c * c + c / q + 1.0;
    Biquad {
        b0: (b2 * c * c + b1 * c + b0) / norm,
        b1: 2.0 * (b0 - b2 * c * c) / norm,
        b2: (b2 * c * c - b1 * c + b0) / norm,
        a1: 2.0 * (1.0 - c * c) / norm,
        a2: (c * c - c / q + 1.0) / norm,
    }
}

pub(super) fn low_pass(q: f64, hz: f64, rate_hz: f64) -> Biquad {
    analog([0.0, 0.0, 1.0], q, hz, rate_hz)
}

pub(super) fn band_pass(q: f64, hz: f64, rate_hz: f64) -> Biquad {
    analog([0.0, 1.0 / q, 0.0], q, hz, rate_hz)
}

/// Designs a filter with unit gain in which a fraction of the signal passes through a resonance: `1
/// - share + share * mode`.
pub(super) fn mode(share: f64, damping: f64, hz: f64, rate_hz: f64) -> Biquad {
    let (rest, q) = (1.0 - share, 0.5 / damping);
    analog([rest, rest / q, 1.0], q, hz, rate_hz)
}

/// First-order low-pass; `hz` must be well below half the sample rate.
#[derive(Debug, Clone)]
pub(super) struct OnePole {
    keep: f64,
    state: f64,
}

impl OnePole {
    pub(super) fn new(hz: f64, rate_hz: f64) -> Self {
        Self { keep: libm::exp(-2.0 * PI * hz / rate_hz), state: 0.0 }
    }

    /// Creates a low-pass that has already settled to a constant input.
    pub(super) fn settled(hz: f64, rate_hz: f64, state: f64) -> Self {
        Self { state, ..Self::new(hz, rate_hz) }
    }

    /// Returns the squared gain at a frequency.
    pub(super) fn low_pass_power(&self, hz: f64, rate_hz: f64) -> f64 {
        let part = 1.0 - self.keep;
        part * part / self.pole_power(hz, rate_hz)
    }

    /// Returns the squared gain, at a frequency, of the high-pass filter whose output is the input
    /// minus the output of this low-pass.
    pub(super) fn high_pass_power(&self, hz: f64, rate_hz: f64) -> f64 {
        // 1 - (1 - k) / (1 - k / z) = k (1 - 1 / z) / (1 - k / z).
        let difference = 2.0 - 2.0 * libm::cos(2.0 * PI * hz / rate_hz);
        self.keep * self.keep * difference / self.pole_power(hz, rate_hz)
    }

    fn pole_power(&self, hz: f64, rate_hz: f64) -> f64 {
        1.0 + self.keep * (self.keep - 2.0 * libm::cos(2.0 * PI * hz / rate_hz))
    }

    pub(super) fn tick(&mut self, x: f64) -> f64 {
        self.state = x + self.keep * (self.state - x);
        self.state
    }
}
