//! Filters of the simulated hand, skin and rig.

use std::f64::consts::PI;

use htex_dsp::spectrum::Complex;

/// Second-order section, transposed direct form II.
#[derive(Debug, Clone, Default)]
pub(super) struct Biquad {
    b: [f64; 3],
    a: [f64; 2],
    state: [f64; 2],
}

impl Biquad {
    /// Creates `b2 s^2 + b1 s + b0` over `s^2 + s/q + 1`, s in units of 2 pi `hz`, by the bilinear transform, exact at `hz`.
    fn analog(numerator: [f64; 3], q: f64, hz: f64, rate_hz: f64) -> Self {
        let c = 1.0 / libm::tan(PI * hz / rate_hz);
        let [b2, b1, b0] = numerator;
        let norm = c * c + c / q + 1.0;
        Self {
            b: [
                (b2 * c * c + b1 * c + b0) / norm,
                2.0 * (b0 - b2 * c * c) / norm,
                (b2 * c * c - b1 * c + b0) / norm,
            ],
            a: [2.0 * (1.0 - c * c) / norm, (c * c - c / q + 1.0) / norm],
            state: [0.0; 2],
        }
    }

    pub(super) fn low_pass(q: f64, hz: f64, rate_hz: f64) -> Self {
        Self::analog([0.0, 0.0, 1.0], q, hz, rate_hz)
    }

    pub(super) fn band_pass(q: f64, hz: f64, rate_hz: f64) -> Self {
        Self::analog([0.0, 1.0 / q, 0.0], q, hz, rate_hz)
    }

    /// Creates a filter of unit gain with a part of the signal passing a resonance: `1 - share + share * mode`.
    pub(super) fn mode(share: f64, damping: f64, hz: f64, rate_hz: f64) -> Self {
        let (rest, q) = (1.0 - share, 0.5 / damping);
        Self::analog([rest, rest / q, 1.0], q, hz, rate_hz)
    }

    /// Returns the frequency response.
    pub(super) fn response(&self, hz: f64, rate_hz: f64) -> Complex<f64> {
        let angle = -2.0 * PI * hz / rate_hz;
        let delay = Complex::new(libm::cos(angle), libm::sin(angle));
        let [b0, b1, b2] = self.b;
        let [a1, a2] = self.a;
        (delay * (delay * b2 + b1) + b0) / (delay * (delay * a2 + a1) + 1.0)
    }

    pub(super) fn tick(&mut self, x: f64) -> f64 {
        let y = self.b[0] * x + self.state[0];
        self.state[0] = self.b[1] * x - self.a[0] * y + self.state[1];
        self.state[1] = self.b[2] * x - self.a[1] * y;
        y
    }
}

/// First-order low-pass, `hz` well below half the rate.
#[derive(Debug, Clone)]
pub(super) struct OnePole {
    keep: f64,
    state: f64,
}

impl OnePole {
    pub(super) fn new(hz: f64, rate_hz: f64) -> Self {
        Self {
            keep: libm::exp(-2.0 * PI * hz / rate_hz),
            state: 0.0,
        }
    }

    pub(super) fn tick(&mut self, x: f64) -> f64 {
        self.state = x + self.keep * (self.state - x);
        self.state
    }
}
