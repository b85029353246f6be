//! A bank of sine oscillators whose phase never drifts.
//!
//! Each oscillator counts its phase in 64-bit fixed point (one cycle is 2^64), so that a day of
//! samples is as exact as the first. Between anchors a rotation makes the samples; at each anchor
//! the rotation restarts from the counted phase.

use alloc::vec::Vec;

/// Samples between two anchors.
const ANCHOR_INTERVAL: u32 = 512;
/// Length of a change of amplitudes and frequencies, seconds.
const RAMP_S: f64 = 0.010;
const CYCLE: f64 = 18_446_744_073_709_551_616.0; // 2^64

/// One sinusoid: `amplitude · cos(2π frequency_hz t + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sine {
    /// Frequency, hertz, at least 0 and below the Nyquist frequency.
    pub frequency_hz: f64,
    /// Amplitude, in the unit of the signal.
    pub amplitude: f64,
    /// Phase at the first sample, cycles in `[0, 1)`. Only read when the oscillator starts.
    pub phase_cycles: f64,
}

#[derive(Debug, Clone, Default)]
struct Oscillators {
    phase: Vec<u64>,
    increment: Vec<u64>,
    cos: Vec<f64>,
    sin: Vec<f64>,
    turn_cos: Vec<f64>,
    turn_sin: Vec<f64>,
    /// Change of `increment` a sample, while frequencies glide (two's complement).
    bend: Vec<u64>,
    bend_cos: Vec<f64>,
    bend_sin: Vec<f64>,
    goal: Vec<u64>,
    amplitude: Vec<f64>,
    step: Vec<f64>,
    target: Vec<f64>,
}

/// Oscillators summed to one signal.
#[derive(Debug, Clone)]
pub struct SineBank {
    rate_hz: f64,
    ramp_len: u32,
    ramp_left: u32,
    since_anchor: u32,
    osc: Oscillators,
}

impl SineBank {
    /// A bank of up to `capacity` oscillators at `rate_hz`, playing `sines`.
    ///
    /// Sines at or above the Nyquist frequency are silent.
    pub fn new(rate_hz: f64, capacity: usize, sines: &[Sine]) -> Self {
        let zeros = || alloc::vec![0.0; capacity];
        let mut bank = Self {
            rate_hz,
            ramp_len: libm::ceil(RAMP_S * rate_hz).clamp(1.0, 1e9) as u32,
            ramp_left: 0,
            since_anchor: 0,
            osc: Oscillators {
                phase: alloc::vec![0; capacity],
                increment: alloc::vec![0; capacity],
                cos: zeros(),
                sin: zeros(),
                turn_cos: zeros(),
                turn_sin: zeros(),
                bend: alloc::vec![0; capacity],
                bend_cos: alloc::vec![1.0; capacity],
                bend_sin: zeros(),
                goal: alloc::vec![0; capacity],
                amplitude: zeros(),
                step: zeros(),
                target: zeros(),
            },
        };
        for (i, sine) in sines.iter().take(capacity).enumerate() {
            bank.osc.phase[i] = cycles_to_fixed(sine.phase_cycles);
            bank.set(i, Some(sine));
            bank.osc.amplitude[i] = bank.osc.target[i];
            bank.osc.increment[i] = bank.osc.goal[i];
        }
        bank.anchor();
        bank
    }

    /// Changes to `sines` from the next sample on: over 10 ms amplitudes ramp and frequencies
    /// glide, phases go on. Oscillators are matched by index. Does not allocate.
    pub fn retune(&mut self, sines: &[Sine]) {
        self.advance();
        for i in 0..self.osc.phase.len() {
            let silent = self.osc.amplitude[i] == 0.0;
            self.set(i, sines.get(i));
            if silent {
                // Nothing is heard: it may start anywhere.
                self.osc.increment[i] = self.osc.goal[i];
                self.osc.phase[i] = sines.get(i).map_or(0, |s| cycles_to_fixed(s.phase_cycles));
            }
        }
        self.ramp_left = self.ramp_len;
        let scale = 1.0 / f64::from(self.ramp_len);
        for i in 0..self.osc.phase.len() {
            self.osc.step[i] = (self.osc.target[i] - self.osc.amplitude[i]) * scale;
            let change = self.osc.goal[i].wrapping_sub(self.osc.increment[i]) as i64;
            self.osc.bend[i] = (change / i64::from(self.ramp_len)) as u64;
        }
        self.anchor();
    }

    /// Fills `out` with the next samples. Does not allocate.
    pub fn render(&mut self, out: &mut [f32]) {
        let mut done = 0;
        while done < out.len() {
            if self.since_anchor == ANCHOR_INTERVAL {
                self.advance();
                self.anchor();
            }
            let left = (ANCHOR_INTERVAL - self.since_anchor) as usize;
            let run = if self.ramp_left > 0 {
                left.min(self.ramp_left as usize)
            } else {
                left
            }
            .min(out.len() - done);
            let chunk = &mut out[done..done + run];
            if self.ramp_left > 0 {
                self.run_ramp(chunk);
            } else {
                self.run_steady(chunk);
            }
            self.since_anchor += run as u32;
            done += run;
            self.end_ramp_if_due(run);
        }
    }

    fn set(&mut self, i: usize, sine: Option<&Sine>) {
        let heard = sine.filter(|s| s.frequency_hz < 0.5 * self.rate_hz);
        self.osc.target[i] = heard.map_or(0.0, |s| s.amplitude);
        // An oscillator that fades out keeps its frequency.
        self.osc.goal[i] = heard.map_or(self.osc.increment[i], |s| {
            cycles_to_fixed(s.frequency_hz / self.rate_hz)
        });
    }

    /// Brings the counted phases and increments up to the current sample.
    fn advance(&mut self) {
        let n = u64::from(self.since_anchor);
        for i in 0..self.osc.phase.len() {
            let bend = self.osc.bend[i];
            let turned = self.osc.increment[i]
                .wrapping_mul(n)
                .wrapping_add(bend.wrapping_mul(n * (n + 1) / 2));
            self.osc.phase[i] = self.osc.phase[i].wrapping_add(turned);
            self.osc.increment[i] = self.osc.increment[i].wrapping_add(bend.wrapping_mul(n));
        }
        self.since_anchor = 0;
    }

    fn end_ramp_if_due(&mut self, run: usize) {
        if self.ramp_left == 0 {
            return;
        }
        self.ramp_left -= run as u32;
        if self.ramp_left == 0 {
            self.advance();
            self.osc.amplitude.copy_from_slice(&self.osc.target);
            self.osc.increment.copy_from_slice(&self.osc.goal);
            self.osc.bend.fill(0);
            self.anchor();
        }
    }

    /// Restarts the rotations from the counted phases.
    fn anchor(&mut self) {
        for i in 0..self.osc.phase.len() {
            let (sin, cos) = libm::sincos(fixed_to_radians(self.osc.phase[i]));
            let (turn_sin, turn_cos) = libm::sincos(fixed_to_radians(self.osc.increment[i]));
            self.osc.cos[i] = cos;
            self.osc.sin[i] = sin;
            self.osc.turn_cos[i] = turn_cos;
            self.osc.turn_sin[i] = turn_sin;
            let (bend_sin, bend_cos) = libm::sincos(fixed_to_radians(self.osc.bend[i]));
            self.osc.bend_cos[i] = bend_cos;
            self.osc.bend_sin[i] = bend_sin;
        }
    }

    fn run_steady(&mut self, out: &mut [f32]) {
        for sample in out {
            *sample = self.osc.sum_and_turn() as f32;
        }
    }

    fn run_ramp(&mut self, out: &mut [f32]) {
        for sample in out {
            for (a, step) in self.osc.amplitude.iter_mut().zip(&self.osc.step) {
                *a += step;
            }
            self.osc.bend_turns();
            *sample = self.osc.sum_and_turn() as f32;
        }
    }
}

impl Oscillators {
    #[inline]
    fn sum_and_turn(&mut self) -> f64 {
        let n = self.cos.len();
        let (cos, sin) = (&mut self.cos[..n], &mut self.sin[..n]);
        let (tc, ts) = (&self.turn_cos[..n], &self.turn_sin[..n]);
        let amplitude = &self.amplitude[..n];
        let mut sum = 0.0;
        for i in 0..n {
            sum += amplitude[i] * cos[i];
            let next = cos[i] * tc[i] - sin[i] * ts[i];
            sin[i] = sin[i] * tc[i] + cos[i] * ts[i];
            cos[i] = next;
        }
        sum
    }

    /// Changes each oscillator's frequency by its bend.
    fn bend_turns(&mut self) {
        for i in 0..self.turn_cos.len() {
            let (c, s) = (self.turn_cos[i], self.turn_sin[i]);
            self.turn_cos[i] = c * self.bend_cos[i] - s * self.bend_sin[i];
            self.turn_sin[i] = s * self.bend_cos[i] + c * self.bend_sin[i];
        }
    }
}

fn cycles_to_fixed(cycles: f64) -> u64 {
    // `as` saturates, and a fraction below 1 times 2^64 fits.
    ((cycles - libm::floor(cycles)) * CYCLE) as u64
}

fn fixed_to_radians(phase: u64) -> f64 {
    // Signed, so that small negative angles keep their precision.
    (phase as i64) as f64 * (core::f64::consts::TAU / CYCLE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_sines() -> [Sine; 2] {
        [
            Sine {
                frequency_hz: 70.0,
                amplitude: 1.0,
                phase_cycles: 0.0,
            },
            Sine {
                frequency_hz: 333.3,
                amplitude: 0.5,
                phase_cycles: 0.25,
            },
        ]
    }

    #[test]
    fn matches_the_closed_form_at_any_block_size() {
        let mut out = alloc::vec![0.0f32; 30_000];
        let mut bank = SineBank::new(20_000.0, 4, &two_sines());
        for block in out.chunks_mut(37) {
            bank.render(block);
        }
        for (n, y) in out.iter().enumerate() {
            let t = n as f64 / 20_000.0;
            let w = core::f64::consts::TAU * t;
            let expected = libm::cos(w * 70.0) - 0.5 * libm::sin(w * 333.3);
            assert!((f64::from(*y) - expected).abs() < 2e-7, "sample {n}");
        }
    }

    #[test]
    fn retune_keeps_the_signal_continuous() {
        let mut bank = SineBank::new(20_000.0, 2, &two_sines());
        let mut out = alloc::vec![0.0f32; 2_000];
        bank.render(&mut out[..1_000]);
        bank.retune(&[Sine {
            frequency_hz: 90.0,
            amplitude: 0.2,
            phase_cycles: 0.0,
        }]);
        bank.render(&mut out[1_000..]);
        // Steepest slope: 2π (70·1 + 333.3·0.5) / 20 kHz, plus the ramp's own.
        let step = out
            .windows(2)
            .map(|w| (w[1] - w[0]).abs())
            .fold(0.0, f32::max);
        assert!(step < 0.09, "{step}");
    }
}
