//! Sample-rate conversion by a rational ratio L/M, exact or approximate: the general case of
//! [`crate::resample`].

use alloc::sync::Arc;
use alloc::vec::Vec;

/// Number of phases in an interpolated kernel. The kernel has one more row than phases.
pub(crate) const INTERPOLATED_PHASES: u64 = 512;
const CHUNK: usize = 256;

/// One polyphase filter. Output k lies at the time k·M/L, counted in input samples.
#[derive(Debug, Clone)]
pub(crate) struct Polyphase {
    /// L.
    up: usize,
    /// Integer and fractional part of M/L. The unit of the fractional part is 1/L.
    step: (usize, usize),
    taps: usize,
    /// The kernel, with one row per phase, and one more row if rows are interpolated. All
    /// converters with the same rates share the kernel.
    kernel: Arc<[f32]>,
    exact: bool,
    phase: usize,
    /// Source samples. A kernel row is applied to `history[start..start + taps]`.
    history: Vec<f32>,
    start: usize,
    filled: usize,
}

impl Polyphase {
    /// Makes a filter. `step` contains the integer part and the fractional part of M/L, as in the
    /// field `step`. `taps` is a multiple of eight. The kernel has one row per phase, or
    /// [`INTERPOLATED_PHASES`] rows plus one.
    pub(crate) fn new(up: usize, step: (usize, usize), taps: usize, kernel: Arc<[f32]>) -> Self {
        Self {
            up,
            step,
            taps,
            // An exact kernel has `up` rows. An interpolated kernel has 513 rows, and is used only
            // if `up` is above 1024, so the two cannot be confused.
            exact: kernel.len() == up * taps,
            kernel,
            phase: 0,
            history: alloc::vec![0.0; taps + CHUNK],
            start: 0,
            filled: 0,
        }
    }

    /// Makes a filter between equal rates. Each output lies `phase / phases` of a sample after a
    /// source sample.
    pub(crate) fn with_phase(phase: usize, phases: usize, taps: usize, kernel: Arc<[f32]>) -> Self {
        Self { phase, ..Self::new(phases, (1, 0), taps, kernel) }
    }

    pub(crate) fn process(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        let (whole, rest) = self.step;
        for sample in out {
            if self.start + self.taps > self.filled {
                self.refill(source);
            }
            let window = &self.history[self.start..self.start + self.taps];
            *sample = self.filter(window);
            // The position is counted in whole numbers, so it never drifts.
            self.phase += rest;
            self.start += whole;
            if self.phase >= self.up {
                self.phase -= self.up;
                self.start += 1;
            }
        }
    }

    /// Pulls a few more samples. If the buffer is full, the samples that are still needed are first
    /// moved to its start.
    fn refill(&mut self, source: &mut dyn FnMut(&mut [f32])) {
        while self.start + self.taps > self.filled {
            // Small pulls keep the latency of parameter changes low.
            let wanted = (self.start + self.taps - self.filled).max(8);
            if self.filled + wanted > self.history.len() {
                // At a high ratio the next window may begin after the last sample in the buffer.
                let keep_from = self.start.min(self.filled);
                self.history.copy_within(keep_from..self.filled, 0);
                self.filled -= keep_from;
                self.start -= keep_from;
            }
            let end = (self.filled + wanted).min(self.history.len());
            source(&mut self.history[self.filled..end]);
            self.filled = end;
        }
    }

    #[inline]
    fn filter(&self, window: &[f32]) -> f32 {
        let row = |i: usize| &self.kernel[i * self.taps..(i + 1) * self.taps];
        if self.exact {
            return dot(row(self.phase), window);
        }
        let place = self.phase as f64 / self.up as f64 * INTERPOLATED_PHASES as f64;
        let i = place as usize;
        let t = (place - i as f64) as f32;
        let (a, b) = (dot(row(i), window), dot(row(i + 1), window));
        a + t * (b - a)
    }
}

/// Dot product in eight lanes. Both slices have the same length, a multiple of eight.
#[inline(always)]
pub(crate) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0.0f32; 8];
    for (x, y) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
        for i in 0..8 {
            lanes[i] += x[i] * y[i];
        }
    }
    sum(&lanes)
}

/// Sums the eight lanes. The function is not inlined. Otherwise its additions across lanes would
/// keep compilers from vectorising the loop of [`dot`], and the loop would take 50 % more time.
#[inline(never)]
fn sum(lanes: &[f32; 8]) -> f32 {
    (lanes[0] + lanes[4]) + (lanes[1] + lanes[5]) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]))
}
