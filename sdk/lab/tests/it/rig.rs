//! A simulated setup, hit by a hammer.
#![allow(dead_code)] // The command's tests use a part of it.

use std::f64::consts::PI;

pub const RATE_HZ: f64 = 10_000.0;

/// A resonance, `ω² / (s² + 2 ζ ω s + ω²)`, discretised by the bilinear transform so that its
/// frequency stays.
pub struct Rig {
    tangent: f64,
    damping: f64,
}

impl Rig {
    pub fn new(frequency_hz: f64, damping: f64) -> Self {
        let tangent = (PI * frequency_hz / RATE_HZ).tan();
        Self { tangent, damping }
    }

    /// Returns the frequency and the magnitude of the largest response.
    pub fn peak(&self) -> (f64, f64) {
        let z = self.damping;
        let warped = (self.tangent * (1.0 - 2.0 * z * z).sqrt()).atan();
        (RATE_HZ / PI * warped, 1.0 / (2.0 * z * (1.0 - z * z).sqrt()))
    }

    pub fn filter(&self, input: &[f64]) -> Vec<f64> {
        let (k, z) = (self.tangent, self.damping);
        let d = 1.0 + 2.0 * z * k + k * k;
        let (b, a1, a2) = (k * k / d, 2.0 * (k * k - 1.0) / d, (1.0 - 2.0 * z * k + k * k) / d);
        let (mut x, mut y) = ([0.0; 2], [0.0; 2]);
        let step = |&new: &f64| {
            let out = b * (new + 2.0 * x[0] + x[1]) - a1 * y[0] - a2 * y[1];
            (x, y) = ([new, x[0]], [out, y[0]]);
            out
        };
        input.iter().map(step).collect()
    }
}

/// Returns half-sine pulses of 1 ms. Each hit has a time in seconds and a force.
pub fn pulses(duration_s: f64, hits: &[(f64, f64)]) -> Vec<f64> {
    let mut input = vec![0.0; (duration_s * RATE_HZ) as usize];
    for (time_s, force) in hits {
        let start = (time_s * RATE_HZ).round() as usize;
        for (i, x) in input[start..start + 11].iter_mut().enumerate() {
            *x += force * (PI * i as f64 / 10.0).sin();
        }
    }
    input
}
