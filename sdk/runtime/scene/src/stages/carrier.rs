//! Modulates the amplitude of a carrier, to prevent charge leakage. In Balasubramanian & Vardar
//! 2026, the frequency of the carrier is 7 kHz.

use super::{Entry, Need, Stage, StagePlace};
use crate::file::Effect;
use crate::requirements::Requirements;

/// Number of samples after which the oscillator restarts from its exact phase.
const RENEW: u32 = 1024;

pub(crate) const ENTRY: Entry =
    Entry { effect: Effect::Carrier, name: "carrier", place: StagePlace::Device { need, build } };

fn need(required: &Requirements) -> Need {
    match required.device.carrier_hz {
        Some(carrier_hz) => Need::yes(format!("the device requires a carrier of {carrier_hz} Hz")),
        None => Need::no("the device requires no carrier"),
    }
}

fn build(required: &Requirements, neutral: bool) -> Box<dyn Stage> {
    let carrier_hz = required.device.carrier_hz.filter(|_| !neutral).unwrap_or(0.0);
    let cycles = carrier_hz / required.rate_hz;
    // The phase is in 64-bit fixed point, so it does not drift.
    let step = (cycles.fract() * 2f64.powi(64)) as u64;
    let (sin, cos) = libm::sincos(std::f64::consts::TAU * cycles);
    Box::new(Carrier { step, turn: [cos, sin], phase: 0, at: [1.0, 0.0], left: RENEW })
}

struct Carrier {
    /// Phase increment per sample, in 2^-64 cycles.
    step: u64,
    /// Rotation per sample: cosine and sine.
    turn: [f64; 2],
    phase: u64,
    at: [f64; 2],
    left: u32,
}

impl Carrier {
    fn advance(&mut self) {
        // A rotation is cheaper than a cosine, but its rounding errors add up until it is renewed.
        let ([c, s], [a, b]) = (self.at, self.turn);
        self.at = [c * a - s * b, c * b + s * a];
        self.phase = self.phase.wrapping_add(self.step);
        self.left -= 1;
        if self.left == 0 {
            let angle = std::f64::consts::TAU * (self.phase as f64 / 2f64.powi(64));
            self.at = [libm::cos(angle), libm::sin(angle)];
            self.left = RENEW;
        }
    }
}

impl Stage for Carrier {
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        for sample in out {
            *sample *= self.at[0] as f32;
            self.advance();
        }
    }
}
