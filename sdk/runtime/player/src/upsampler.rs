//! Interpolation from the internal rate to the output's sample rate.

use crate::layout::MOST_ROW;
use crate::words::Words;

/// A polyphase low-pass filter with `row` coefficients per phase, ordered from the oldest input to
/// the newest.
#[derive(Debug, Clone)]
pub(crate) struct Upsampler {
    /// Each input is stored twice, so that the newest inputs are always contiguous.
    history: [f32; 2 * MOST_ROW],
    next: usize,
}

impl Upsampler {
    pub(crate) const ZERO: Self = Self { history: [0.0; 2 * MOST_ROW], next: 0 };

    pub(crate) fn push(&mut self, input: f32, row: usize) {
        for place in [self.next, self.next + row] {
            if let Some(place) = self.history.get_mut(place) {
                *place = input;
            }
        }
        self.next += 1;
        if self.next >= row {
            self.next = 0;
        }
    }

    /// Returns the output sample for the phase with these coefficients.
    pub(crate) fn sample(&self, coefficients: Words<'_>) -> f32 {
        let inputs = self
            .history
            .get(self.next..self.next + coefficients.len())
            .unwrap_or(&[])
            .as_chunks::<4>()
            .0;
        let mut sums = [0.0f32; 4];
        for (c, x) in coefficients.fours().zip(inputs) {
            for i in 0..4 {
                sums[i] += c[i] * x[i];
            }
        }
        (sums[0] + sums[1]) + (sums[2] + sums[3])
    }
}
