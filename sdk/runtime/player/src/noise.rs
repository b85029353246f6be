//! White noise filtered by a symmetrical filter.

use crate::block::{Block, Target};
use crate::layout::MOST_HALF;
use crate::random::Random;

/// Lowest energy of a mixed filter that can be scaled to a level.
const LEAST_ENERGY: f32 = 1e-9;
/// Number of filters that are added to a mix in one pass.
const AT_ONCE: usize = 4;

/// Noise with the spectrum of a symmetrical filter. The coefficients glide when the motion changes.
#[derive(Debug, Clone)]
pub(crate) struct Noise {
    random: Random,
    half: usize,
    centre: f32,
    centre_step: f32,
    /// The coefficients on one side, outwards.
    side: [f32; MOST_HALF],
    step: [f32; MOST_HALF],
    /// Each input is stored twice, so that the newest inputs are always contiguous.
    history: [f32; 2 * (2 * MOST_HALF + 1)],
    next: usize,
}

impl Noise {
    pub(crate) const ZERO: Self = Self {
        random: Random::ZERO,
        half: 0,
        centre: 0.0,
        centre_step: 0.0,
        side: [0.0; MOST_HALF],
        step: [0.0; MOST_HALF],
        history: [0.0; 2 * (2 * MOST_HALF + 1)],
        next: 0,
    };

    /// Starts the noise. All numbers must be zero before the call. The first sample is already
    /// stationary.
    pub(crate) fn start(&mut self, half: usize, seed: u32) {
        (self.half, self.random) = (half, Random::new(seed));
        for _ in 0..self.taps() {
            let input = self.random.noise();
            self.push(input);
        }
    }

    fn taps(&self) -> usize {
        2 * self.half + 1
    }

    /// Starts a glide over `samples` samples to the filter of a motion. If `samples` is 0, sets the
    /// filter at once. Returns the level at the end of the glide.
    pub(crate) fn retune(&mut self, block: &Block<'_>, target: Target, samples: u32) -> f32 {
        if samples == 0 {
            self.silence();
        }
        let half = self.half;
        // `step` first receives the mix of the filters, which saves a second array of this size.
        let (mut centre, step) = (0.0, self.step.get_mut(..half).unwrap_or(&mut []));
        step.fill(0.0);
        for first in (0..block.filters()).step_by(AT_ONCE) {
            let mut weights = [0.0; AT_ONCE];
            for (filter, weight) in (first..block.filters()).zip(&mut weights) {
                for (condition, part) in target.weights.iter() {
                    *weight += part * block.filter_weight(condition, filter);
                }
                *weight *= block.filter_scale(filter);
            }
            // An incomplete group is filled up with a filter of weight 0, which does not change any
            // bit.
            let filters: [usize; AT_ONCE] =
                core::array::from_fn(|i| (first + i).min(block.filters() - 1));
            let filters = filters.map(|filter| block.filter(filter));
            for (weight, filter) in weights.iter().zip(&filters) {
                centre += weight * filter.get(0);
            }
            let [w, x, y, z] = weights;
            let [a, b, c, d] = filters.map(|filter| filter.part(1, half).iter());
            for ((((sum, a), b), c), d) in step.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                // From left to right, as in `c/htex_player.c`, which must give the same bits.
                *sum = *sum + w * a + x * b + y * c + z * d;
            }
        }
        let mut sums = [0.0f32; 4];
        for four in step.as_chunks::<4>().0 {
            for i in 0..4 {
                sums[i] += four[i] * four[i];
            }
        }
        let side = (sums[0] + sums[1]) + (sums[2] + sums[3]);
        let energy = centre * centre + 2.0 * side;
        let (level, gain) = if energy > LEAST_ENERGY {
            (target.level, target.level / libm::sqrtf(energy))
        } else {
            (0.0, 0.0)
        };
        let part = 1.0 / samples.max(1) as f32;
        self.centre_step = (centre * gain - self.centre) * part;
        for (step, c) in step.iter_mut().zip(&self.side) {
            *step = (*step * gain - c) * part;
        }
        if samples == 0 {
            self.glide();
        }
        level
    }

    /// Starts a glide over `samples` samples to silence. If `samples` is 0, the noise is silent at
    /// once.
    pub(crate) fn fade(&mut self, samples: u32) {
        let part = 1.0 / samples.max(1) as f32;
        self.centre_step = -self.centre * part;
        for (step, c) in self.step.iter_mut().zip(&self.side).take(self.half) {
            *step = -c * part;
        }
        if samples == 0 {
            self.silence();
        }
    }

    /// Advances the coefficients by one step of the glide.
    fn glide(&mut self) {
        self.centre += self.centre_step;
        let moved = self.side.iter_mut().zip(&self.step);
        for (c, step) in moved.take(self.half) {
            *c += step;
        }
    }

    /// Sets all coefficients to zero.
    fn silence(&mut self) {
        self.centre = 0.0;
        self.side.fill(0.0);
    }

    fn push(&mut self, input: f32) {
        let taps = self.taps();
        for place in [self.next, self.next + taps] {
            if let Some(place) = self.history.get_mut(place) {
                *place = input;
            }
        }
        self.next += 1;
        if self.next >= taps {
            self.next = 0;
        }
    }

    /// Returns the next sample. If `is_gliding`, advances the glide first. `becomes_silent` means
    /// that this step ends a glide to silence.
    pub(crate) fn next(&mut self, is_gliding: bool, becomes_silent: bool) -> f32 {
        if is_gliding {
            self.glide();
        }
        // The steps have rounding errors, which would leave a faint rest of noise.
        if becomes_silent {
            self.silence();
        }
        self.tick()
    }

    fn tick(&mut self) -> f32 {
        let input = self.random.noise();
        self.push(input);
        let inputs = self.history.get(self.next..self.next + self.taps());
        let Some((before, [middle, after @ ..])) =
            inputs.and_then(|inputs| inputs.split_at_checked(self.half))
        else {
            return 0.0;
        };
        // All lengths are multiples of four. Slices that become shorter compile to fewer
        // instructions than iterators, one of which would be reversed.
        let mut before = before.as_rchunks::<4>().1;
        let mut after = after.as_chunks::<4>().0;
        let mut side = self.side.as_chunks::<4>().0;
        let mut sums = [0.0f32; 4];
        while let ([earlier @ .., b], [a, later @ ..], [c, outer @ ..]) = (before, after, side) {
            for i in 0..4 {
                sums[i] += c[i] * (a[i] + b[3 - i]);
            }
            (before, after, side) = (earlier, later, outer);
        }
        self.centre * middle + ((sums[0] + sums[1]) + (sums[2] + sums[3]))
    }
}
