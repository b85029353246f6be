//! How a texture changes when the motion is beyond the grid of a block.

use crate::layout::{MAX_RATIO, MIN_RATIO};
use crate::power::{exp2, log2};

/// Range of the ratio between a speed and the nearest speed of the grid. Also the range of the
/// factor of frequencies.
const RATIO: (f32, f32) = (MIN_RATIO, MAX_RATIO);
/// Range of the ratio between a force and the nearest force of the grid: from 2^-20 to 2^20.
const FORCE_RATIO: (f32, f32) = (1.0 / 1_048_576.0, 1_048_576.0);

/// The exponents of the law that a texture follows beyond its grid. Let (v, F) be a motion beyond
/// the grid, and (v0, F0) the nearest motion of the grid. The law multiplies frequencies by
/// `(v / v0)^a` and the level by `(v / v0)^b (F / F0)^c`. The player changes only the frequencies
/// of sinusoids, because it cannot change the frequencies of a filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// Exponent a: how frequencies depend on the speed.
    pub frequency_speed: f32,
    /// Exponent b: how the level depends on the speed.
    pub level_speed: f32,
    /// Exponent c: how the level depends on the normal force.
    pub level_force: f32,
}

/// Factors of frequency and level beyond the grid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factors {
    pub(crate) frequency: f32,
    pub(crate) level: f32,
}

impl Factors {
    /// The factors for a motion within the grid.
    pub(crate) const NONE: Self = Self { frequency: 1.0, level: 1.0 };
}

impl Law {
    /// Returns the factors for a motion, given the nearest motion of the grid. Each motion is a
    /// speed and a force, both above 0.
    pub(crate) fn factors(&self, motion: (f32, f32), nearest: (f32, f32)) -> Factors {
        let speed = log2(within(motion.0 / nearest.0, RATIO));
        let force = log2(within(motion.1 / nearest.1, FORCE_RATIO));
        let frequency = exp2(self.frequency_speed * speed);
        Factors {
            frequency: within(frequency, RATIO),
            level: exp2(self.level_speed * speed + self.level_force * force),
        }
    }
}

/// Clamps a number to a range.
fn within(number: f32, range: (f32, f32)) -> f32 {
    // Not `clamp`, which can panic.
    number.max(range.0).min(range.1)
}
