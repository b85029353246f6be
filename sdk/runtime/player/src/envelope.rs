//! The fluctuation of a texture in time: an envelope that multiplies the samples.
//!
//! Its logarithm is a sum of sinusoids at random frequencies. Unlike a filter, a sum of sinusoids
//! cannot become unstable, so no block can make the envelope grow without bound.

use crate::block::StoredFluctuation;
use crate::power::exp2;
use crate::random::Random;
use crate::tones::{CYCLES, cosine};

/// Sinusoids of each part.
const LINES: usize = 8;
/// Lowest frequency of the slow and of the fast part, and the width of the range of each sinusoid,
/// hertz.
const PARTS_HZ: [[f32; 2]; 2] = [[0.5, 0.9375], [8.0, 3.0]];
/// Distinguishes the random numbers from those of the noise.
const STREAM: u32 = 0x666C_7563;
/// Amplitude of a sinusoid, in octaves, for a strength of 1/32 dB: `√(2/8) log2(10) / 640`.
const UNIT: f32 = 0.002_595_256_3;

#[derive(Debug, Clone, Copy)]
struct Line {
    phase: u32,
    step: u32,
}

/// The envelope. Its values are computed only once every few samples, and interpolated for the
/// samples in between.
#[derive(Debug, Clone)]
pub(crate) struct Envelope {
    lines: [[Line; LINES]; 2],
    /// The values before and after the present sample.
    between: [f32; 2],
    /// Number of samples since the previous value.
    count: u16,
}

impl Envelope {
    pub(crate) const ZERO: Self =
        Self { lines: [[Line { phase: 0, step: 0 }; LINES]; 2], between: [0.0; 2], count: 0 };

    /// Starts the envelope at random frequencies and phases.
    pub(crate) fn start(&mut self, stored: StoredFluctuation, rate_hz: f32, seed: u32) {
        let mut random = Random::new(seed ^ STREAM);
        let period = f32::from(stored.period) / rate_hz;
        for (lines, [low, width]) in self.lines.iter_mut().zip(PARTS_HZ) {
            for (i, line) in lines.iter_mut().enumerate() {
                let place = (random.bits() >> 8) as f32 * (1.0 / 16_777_216.0);
                let hertz = low + width * (i as f32 + place);
                line.step = (hertz * period * (1.0 / CYCLES)) as u32;
                line.phase = random.bits();
            }
        }
        self.between = [self.next(stored), self.next(stored)];
    }

    /// The next value.
    fn next(&mut self, stored: StoredFluctuation) -> f32 {
        let mut sums = [0.0f32; 2];
        for (sum, lines) in sums.iter_mut().zip(&mut self.lines) {
            for line in lines {
                *sum += cosine(line.phase);
                line.phase = line.phase.wrapping_add(line.step);
            }
        }
        let [slow, fast] = stored.strength.map(|steps| f32::from(steps) * UNIT);
        exp2(stored.offset + slow * sums[0] + fast * sums[1])
    }

    /// The factor of the next sample.
    pub(crate) fn factor(&mut self, stored: StoredFluctuation) -> f32 {
        if self.count == stored.period {
            self.between = [self.between[1], self.next(stored)];
            self.count = 0;
        }
        let [from, to] = self.between;
        let place = f32::from(self.count) / f32::from(stored.period);
        self.count += 1;
        from + (to - from) * place
    }
}
