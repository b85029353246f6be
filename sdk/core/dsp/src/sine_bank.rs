//! A bank of sine oscillators without phase drift.
//!
//! Each oscillator counts its phase in 64-bit fixed point (one cycle is 2^64). In a day of samples,
//! the phase drifts by less than a millionth of a cycle.
//!
//! The samples are computed by recurrences. At regular intervals (anchors) the recurrences restart
//! from the counted phase. While nothing changes, an oscillator generates eight samples at a time
//! from the previous sixteen: `y[n + 8] = 2 cos(8 w) y[n] - y[n - 8]`. The eight samples do not
//! depend on each other, which suits vector instructions. While amplitudes or frequencies change,
//! the oscillator computes each sample from the sample before it, by rotating a point in the
//! complex plane by the oscillator's angle per sample.

use alloc::vec::Vec;

/// Samples between two anchors. Between two anchors the recurrences drift by less than 1e-10 of an
/// amplitude.
const ANCHOR_INTERVAL: u32 = 4096;
/// Number of samples that an oscillator generates at a time.
const LANES: usize = 8;
/// Number of samples in a chunk. While nothing changes, samples are generated ahead in chunks, and
/// anchors are at their boundaries.
const CHUNK: usize = 64;
/// Duration of a change of amplitudes and frequencies, seconds.
const RAMP_S: f64 = 0.010;
const CYCLE: f64 = 18_446_744_073_709_551_616.0; // 2^64

/// One sinusoid: `amplitude · cos(2π frequency_hz t + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sine {
    /// Frequency, hertz, at least 0 and below the Nyquist frequency.
    pub frequency_hz: f64,
    /// Amplitude, in the unit of the signal.
    pub amplitude: f64,
    /// Phase at the first sample, cycles in `[0, 1)`. Used only when the oscillator starts.
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
    /// Change of `increment` per sample while the frequency glides (two's complement).
    bend: Vec<u64>,
    bend_cos: Vec<f64>,
    bend_sin: Vec<f64>,
    goal: Vec<u64>,
    amplitude: Vec<f64>,
    step: Vec<f64>,
    target: Vec<f64>,
    /// The last eight samples and the next eight samples. Used while nothing changes.
    wave: Vec<[[f64; LANES]; 2]>,
    /// `2 cos(LANES w)`.
    recur: Vec<f64>,
}

/// A bank of oscillators that renders their sum.
///
/// ```
/// use htex_dsp::sine_bank::{Sine, SineBank};
/// let sine = Sine { frequency_hz: 100.0, amplitude: 1.0, phase_cycles: 0.0 };
/// let mut bank = SineBank::new(20_000.0, 1, &[sine]);
/// let mut block = [0.0; 101];
/// bank.render(&mut block);
/// assert!((block[0] - 1.0).abs() < 1e-6 && (block[100] + 1.0).abs() < 1e-6);
/// ```
#[derive(Debug, Clone)]
pub struct SineBank {
    rate_hz: f64,
    ramp_len: u32,
    ramp_left: u32,
    since_anchor: u32,
    /// Number of oscillators that may be audible: all oscillators from this index on are silent.
    heard: usize,
    chunk: [f32; CHUNK],
    osc: Oscillators,
}

impl SineBank {
    /// Makes a bank of up to `capacity` oscillators that plays `sines` at the sample rate
    /// `rate_hz`. Sines at or above the Nyquist frequency are silent.
    pub fn new(rate_hz: f64, capacity: usize, sines: &[Sine]) -> Self {
        let zeros = || alloc::vec![0.0; capacity];
        let mut bank = Self {
            rate_hz,
            ramp_len: libm::ceil(RAMP_S * rate_hz).clamp(1.0, 1e9) as u32,
            ramp_left: 0,
            since_anchor: 0,
            heard: sines.len().min(capacity),
            chunk: [0.0; CHUNK],
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
                wave: alloc::vec![Default::default(); capacity],
                recur: zeros(),
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

    /// Plays `sines` from the next sample on. Amplitudes and frequencies ramp linearly over 10 ms;
    /// phases are continuous. The oscillator with index i changes to sine i. Does not allocate.
    pub fn retune(&mut self, sines: &[Sine]) {
        self.advance();
        // Oscillators that fade out stay in use until the ramp ends.
        self.heard = self.heard.max(sines.len()).min(self.osc.phase.len());
        let scale = 1.0 / f64::from(self.ramp_len);
        for i in 0..self.heard {
            let silent = self.osc.amplitude[i] == 0.0;
            self.set(i, sines.get(i));
            if silent {
                // The oscillator is silent, so its phase may jump.
                self.osc.increment[i] = self.osc.goal[i];
                self.osc.phase[i] = sines.get(i).map_or(0, |s| cycles_to_fixed(s.phase_cycles));
            }
            self.osc.step[i] = (self.osc.target[i] - self.osc.amplitude[i]) * scale;
            // The difference is a signed number, because the frequency may decrease.
            let change = self.osc.goal[i].wrapping_sub(self.osc.increment[i]) as i64;
            // The division drops the remainder. `end_ramp` corrects this by setting the goal
            // itself.
            self.osc.bend[i] = (change / i64::from(self.ramp_len)) as u64;
        }
        self.ramp_left = self.ramp_len;
        self.anchor();
    }

    /// Fills `out` with the next samples. Does not allocate.
    pub fn render(&mut self, out: &mut [f32]) {
        let mut rest = out;
        while !rest.is_empty() {
            if self.since_anchor == ANCHOR_INTERVAL {
                self.advance();
                self.anchor();
            }
            let run = if self.ramp_left > 0 { self.run_ramp(rest) } else { self.run_steady(rest) };
            rest = &mut rest[run..];
        }
    }

    fn set(&mut self, i: usize, sine: Option<&Sine>) {
        let heard = sine.filter(|s| s.frequency_hz < 0.5 * self.rate_hz);
        self.osc.target[i] = heard.map_or(0.0, |s| s.amplitude);
        // An oscillator that fades out keeps its frequency.
        self.osc.goal[i] =
            heard.map_or(self.osc.increment[i], |s| cycles_to_fixed(s.frequency_hz / self.rate_hz));
    }

    /// Advances the counted phases and increments to the current sample.
    fn advance(&mut self) {
        let n = u64::from(self.since_anchor);
        for i in 0..self.heard {
            let bend = self.osc.bend[i];
            // The sum of all increments since the anchor. The factor is `n (n + 1) / 2` and not `n
            // (n - 1) / 2`, because `changing_sample` adds the bend to the increment before it uses
            // the increment.
            let turned = self.osc.increment[i]
                .wrapping_mul(n)
                .wrapping_add(bend.wrapping_mul(n * (n + 1) / 2));
            self.osc.phase[i] = self.osc.phase[i].wrapping_add(turned);
            self.osc.increment[i] = self.osc.increment[i].wrapping_add(bend.wrapping_mul(n));
        }
        self.since_anchor = 0;
    }

    /// Restarts the recurrences from the counted phases.
    fn anchor(&mut self) {
        for i in 0..self.heard {
            self.osc.anchor(i);
            if self.ramp_left == 0 {
                self.osc.anchor_wave(i);
            }
        }
    }

    /// Renders samples of a constant sound up to the end of the chunk; returns their number.
    fn run_steady(&mut self, out: &mut [f32]) -> usize {
        let at = self.since_anchor as usize % CHUNK;
        // A chunk is always computed whole, so its samples do not depend on the block sizes.
        if at == 0 {
            self.chunk = self.osc.steady_chunk(self.heard);
        }
        let run = out.len().min(CHUNK - at);
        out[..run].copy_from_slice(&self.chunk[at..at + run]);
        self.since_anchor += run as u32;
        run
    }

    /// Renders samples of a ramp up to its end or the next anchor; returns their number.
    fn run_ramp(&mut self, out: &mut [f32]) -> usize {
        // The run ends at the next anchor, because `render` restarts the recurrences only between
        // two runs.
        let left = self.ramp_left.min(ANCHOR_INTERVAL - self.since_anchor);
        let run = out.len().min(left as usize);
        for sample in &mut out[..run] {
            *sample = self.osc.changing_sample(self.heard) as f32;
        }
        self.since_anchor += run as u32;
        self.ramp_left -= run as u32;
        if self.ramp_left == 0 {
            self.end_ramp();
        }
        run
    }

    fn end_ramp(&mut self) {
        self.advance();
        self.osc.amplitude.copy_from_slice(&self.osc.target);
        self.osc.increment.copy_from_slice(&self.osc.goal);
        self.osc.bend.fill(0);
        let last = self.osc.amplitude.iter().rposition(|a| *a != 0.0);
        self.heard = last.map_or(0, |last| last + 1);
        self.anchor();
    }
}

impl Oscillators {
    /// Restarts the rotation of oscillator `i` from its counted phase: sets the point and the angle
    /// per sample.
    fn anchor(&mut self, i: usize) {
        (self.sin[i], self.cos[i]) = crate::trig::sincos(fixed_to_radians(self.phase[i]));
        (self.turn_sin[i], self.turn_cos[i]) =
            crate::trig::sincos(fixed_to_radians(self.increment[i]));
        (self.bend_sin[i], self.bend_cos[i]) = crate::trig::sincos(fixed_to_radians(self.bend[i]));
    }

    /// Computes the samples around an anchor, and the factor of the recurrence.
    fn anchor_wave(&mut self, i: usize) {
        let start = (self.amplitude[i] * self.cos[i], self.amplitude[i] * self.sin[i]);
        let turn = (self.turn_cos[i], self.turn_sin[i]);
        let [before, now] = &mut self.wave[i];
        let mut ahead = start;
        for y in now.iter_mut() {
            *y = ahead.0;
            ahead = turned(ahead, turn);
        }
        let mut behind = start;
        for y in before.iter_mut().rev() {
            behind = turned(behind, (turn.0, -turn.1));
            *y = behind.0;
        }
        // LANES is 2 * 2 * 2.
        let stride = (0..3).fold(turn, |turn, _| turned(turn, turn));
        self.recur[i] = 2.0 * stride.0;
    }

    /// Renders a chunk of the first `heard` oscillators, while nothing changes.
    fn steady_chunk(&mut self, heard: usize) -> [f32; CHUNK] {
        let mut sum = [[0.0; LANES]; CHUNK / LANES];
        for (wave, &recur) in self.wave[..heard].iter_mut().zip(&self.recur) {
            let [mut before, mut now] = *wave;
            for sum in &mut sum {
                for lane in 0..LANES {
                    sum[lane] += now[lane];
                    let next = recur * now[lane] - before[lane];
                    before[lane] = now[lane];
                    now[lane] = next;
                }
            }
            *wave = [before, now];
        }
        let mut chunk = [0.0; CHUNK];
        for (samples, sum) in chunk.as_chunks_mut::<LANES>().0.iter_mut().zip(&sum) {
            *samples = sum.map(|sum| sum as f32);
        }
        chunk
    }

    /// Renders one sample of the first `n` oscillators, and advances their amplitudes and
    /// frequencies.
    #[inline]
    fn changing_sample(&mut self, n: usize) -> f64 {
        let (cos, sin) = (&mut self.cos[..n], &mut self.sin[..n]);
        let (tc, ts) = (&mut self.turn_cos[..n], &mut self.turn_sin[..n]);
        let (bc, bs) = (&self.bend_cos[..n], &self.bend_sin[..n]);
        let (amplitude, step) = (&mut self.amplitude[..n], &self.step[..n]);
        let mut sum = 0.0;
        for i in 0..n {
            amplitude[i] += step[i];
            sum += amplitude[i] * cos[i];
            (tc[i], ts[i]) = turned((tc[i], ts[i]), (bc[i], bs[i]));
            (cos[i], sin[i]) = turned((cos[i], sin[i]), (tc[i], ts[i]));
        }
        sum
    }
}

/// A point rotated by an angle, both given as cosine and sine.
#[inline]
fn turned((cos, sin): (f64, f64), (by_cos, by_sin): (f64, f64)) -> (f64, f64) {
    (cos * by_cos - sin * by_sin, sin * by_cos + cos * by_sin)
}

fn cycles_to_fixed(cycles: f64) -> u64 {
    // A fraction below 1, multiplied by 2^64, fits into the integer. For larger numbers `as` would
    // saturate.
    ((cycles - libm::floor(cycles)) * CYCLE) as u64
}

fn fixed_to_radians(phase: u64) -> f64 {
    // The phase is converted as a signed number, so that small negative angles keep their
    // precision.
    (phase as i64) as f64 * (core::f64::consts::TAU / CYCLE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_sines() -> [Sine; 2] {
        [
            Sine { frequency_hz: 70.0, amplitude: 1.0, phase_cycles: 0.0 },
            Sine { frequency_hz: 333.3, amplitude: 0.5, phase_cycles: 0.25 },
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
        bank.retune(&[Sine { frequency_hz: 90.0, amplitude: 0.2, phase_cycles: 0.0 }]);
        bank.render(&mut out[1_000..]);
        // The steepest slope is 2π (70·1 + 333.3·0.5) / 20 kHz, plus the slope of the ramp itself.
        let step = out.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f32::max);
        assert!(step < 0.09, "{step}");
        // The test uses all oscillators of the bank. The samples contain whole periods of both
        // sines, to within a thousandth of a period.
        bank.retune(&two_sines());
        let mut out = alloc::vec![0.0f32; 20_200];
        bank.render(&mut out);
        let power = out[200..].iter().map(|x| f64::from(x * x)).sum::<f64>() / 20_000.0;
        assert!((power - 0.625).abs() < 2e-3, "{power}");
    }
}
