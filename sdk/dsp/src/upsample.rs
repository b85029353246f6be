//! Raising a rate by a whole number: the usual case of [`crate::resample`].
//!
//! A few steps of the source are turned into all their outputs at once. The outputs of one phase stand
//! side by side in vector registers, so no sum runs across a register, and what comes out does not
//! depend on the sizes in which it is asked for.

use alloc::sync::Arc;
use alloc::vec::Vec;

/// Source samples taken at once.
const STEPS: usize = 8;

#[derive(Debug, Clone)]
pub(crate) struct Upsampler {
    up: usize,
    taps: usize,
    /// One row of `taps` for each of the `up` phases.
    kernel: Arc<[f32]>,
    /// Where the row of phase 0 has its 1, when all else in it is 0.
    copies: Option<usize>,
    /// The samples that `STEPS` windows of `taps` see.
    history: Vec<f32>,
    primed: bool,
    ready: Vec<f32>,
    taken: usize,
}

impl Upsampler {
    /// `taps` is even, and the kernel has `up` rows of them.
    pub(crate) fn new(up: usize, taps: usize, kernel: Arc<[f32]>) -> Self {
        let ready = alloc::vec![0.0; up * STEPS];
        Self {
            up,
            taps,
            copies: only_one(&kernel[..taps]),
            kernel,
            history: alloc::vec![0.0; taps - 1 + STEPS],
            primed: false,
            taken: ready.len(),
            ready,
        }
    }

    pub(crate) fn process(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        let mut rest = out;
        while !rest.is_empty() {
            if self.taken == self.ready.len() {
                self.advance(source);
            }
            let run = rest.len().min(self.ready.len() - self.taken);
            let (now, later) = rest.split_at_mut(run);
            now.copy_from_slice(&self.ready[self.taken..self.taken + run]);
            self.taken += run;
            rest = later;
        }
    }

    fn advance(&mut self, source: &mut dyn FnMut(&mut [f32])) {
        // The first output stands at the centre of a window that is full.
        let kept = if self.primed { self.taps - 1 } else { 0 };
        let from = self.history.len() - kept;
        self.history.copy_within(from.., 0);
        source(&mut self.history[kept..]);
        self.primed = true;
        for (phase, row) in self.kernel.chunks_exact(self.taps).enumerate() {
            let steps = match self.copies {
                Some(place) if phase == 0 => self.history[place..].first_chunk().copied(),
                _ => Some(filter(row, &self.history)),
            };
            for (frame, y) in self
                .ready
                .chunks_exact_mut(self.up)
                .zip(steps.iter().flatten())
            {
                frame[phase] = *y;
            }
        }
        self.taken = 0;
    }
}

/// A row at `STEPS` neighbouring places; two sums each, so that one need not wait for the other.
#[inline]
fn filter(row: &[f32], history: &[f32]) -> [f32; STEPS] {
    let mut sums = [[0.0f32; STEPS]; 2];
    for (i, pair) in row.as_chunks::<2>().0.iter().enumerate() {
        for (sum, (j, k)) in sums.iter_mut().zip(pair.iter().enumerate()) {
            let Some(window) = history[2 * i + j..].first_chunk::<STEPS>() else {
                continue;
            };
            for t in 0..STEPS {
                sum[t] += k * window[t];
            }
        }
    }
    core::array::from_fn(|t| sums[0][t] + sums[1][t])
}

/// The place of the only coefficient that is not 0 (to rounding), and is 1.
fn only_one(row: &[f32]) -> Option<usize> {
    let one = row.iter().position(|x| (x - 1.0).abs() < 1e-7)?;
    let others = row.iter().enumerate().filter(|(i, _)| *i != one);
    others
        .map(|(_, x)| x.abs())
        .all(|x| x < 1e-9)
        .then_some(one)
}
