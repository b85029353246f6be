//! Sample-rate conversion by an integer factor: the usual case of [`crate::resample`].
//!
//! Each step takes a few source samples, and computes the output samples for all phases of the
//! filter. A vector register contains outputs of the same phase for successive source samples. As a
//! result, no sum runs across the lanes of a register, and the output does not depend on the block
//! sizes.
//!
//! The converter pulls source samples in multiples of eight. Therefore the source sample at which a
//! voice retunes does not depend on the conversion stages that follow the voice.

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::wide::{Work, wide};

/// Number of source samples pulled at a time. It is small, because samples that have already been
/// pulled delay a change of parameters. At high sample rates it is doubled ([`MANY`]).
const FEW: usize = 8;
const MANY: usize = 16;
const MANY_HZ: f64 = 3_500.0;
/// Number of products that are summed before they are added to the total.
const PART: usize = 12;

#[derive(Debug, Clone)]
pub(crate) struct Upsampler {
    up: usize,
    steps: usize,
    taps: usize,
    /// One row of `taps` for each of the `up` phases.
    kernel: Arc<[f32]>,
    /// If the row of phase 0 has only one nonzero coefficient and this is 1, the index of this
    /// coefficient. In this case the output of phase 0 is a copy of an input.
    copies: Option<usize>,
    /// The samples that `steps` windows of `taps` cover. Some more samples precede them, so that
    /// the length of a pull is a multiple of `steps`. An intermediate stage that also pulls
    /// multiples of `steps` then never computes samples too early.
    history: Vec<f32>,
    primed: bool,
    ready: Vec<f32>,
    taken: usize,
}

impl Upsampler {
    /// `taps` is even, and the kernel has `up` rows of `taps` coefficients.
    pub(crate) fn new(up: usize, taps: usize, kernel: Arc<[f32]>, source_hz: f64) -> Self {
        let steps = if source_hz < MANY_HZ { FEW } else { MANY };
        let ready = alloc::vec![0.0; up * steps];
        Self {
            up,
            steps,
            taps,
            copies: only_one(&kernel[..taps]),
            kernel,
            history: alloc::vec![0.0; (taps - 1).next_multiple_of(steps) + steps],
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

    /// Number of source samples before the window of the first output.
    pub(crate) fn skipped(&self) -> usize {
        self.history.len() - self.steps - (self.taps - 1)
    }

    fn advance(&mut self, source: &mut dyn FnMut(&mut [f32])) {
        // The first output lies at the centre of the first full window.
        if self.primed {
            self.history.copy_within(self.steps.., 0);
            let kept = self.history.len() - self.steps;
            source(&mut self.history[kept..]);
        } else {
            source(&mut self.history);
            self.primed = true;
        }
        match self.steps {
            FEW => wide(Outputs::<FEW>(self)),
            _ => wide(Outputs::<MANY>(self)),
        }
        self.taken = 0;
    }
}

/// All outputs of the current windows.
struct Outputs<'a, const STEPS: usize>(&'a mut Upsampler);

impl<const STEPS: usize> Work for Outputs<'_, STEPS> {
    #[inline(always)]
    fn run(self) {
        let Self(stage) = self;
        let seen = &stage.history[stage.skipped()..];
        for (phase, row) in stage.kernel.chunks_exact(stage.taps).enumerate() {
            let steps = match stage.copies {
                Some(place) if phase == 0 => seen[place..].first_chunk().copied(),
                _ => Some(filter::<STEPS>(row, seen)),
            };
            let (steps, places) = (steps.unwrap_or([0.0; STEPS]), &mut stage.ready[phase..]);
            for i in 0..STEPS {
                places[i * stage.up] = steps[i];
            }
        }
    }
}

/// Applies a row at `STEPS` neighbouring positions. The sum is split into parts: a long sum in
/// single precision would lose precision, and the parts can be computed independently.
#[inline(always)]
fn filter<const STEPS: usize>(row: &[f32], history: &[f32]) -> [f32; STEPS] {
    let mut sums = [0.0f32; STEPS];
    for (i, part) in row.chunks(PART).enumerate() {
        let mut partial = [0.0f32; STEPS];
        let windows = history[i * PART..].windows(STEPS);
        for (coefficient, window) in part.iter().zip(windows) {
            for t in 0..STEPS {
                partial[t] += coefficient * window[t];
            }
        }
        for t in 0..STEPS {
            sums[t] += partial[t];
        }
    }
    sums
}

/// Returns the index of the only coefficient that is not 0 up to rounding, if it is 1.
fn only_one(row: &[f32]) -> Option<usize> {
    let one = row.iter().position(|x| (x - 1.0).abs() < 1e-7)?;
    let others = row.iter().enumerate().filter(|(i, _)| *i != one);
    others.map(|(_, x)| x.abs()).all(|x| x < 1e-9).then_some(one)
}
