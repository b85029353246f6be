//! How a texture follows a motion beyond the grid of a block.

use crate::layout::{MAX_RATIO, MIN_RATIO};
use crate::power::{exp2, log2};

/// Range of the ratio of a speed to the nearest of the grid, and of the factor of frequencies.
const RATIO: (f32, f32) = (MIN_RATIO, MAX_RATIO);
/// Range of the ratio of a force to the nearest of the grid: 2^20 in both directions.
const FORCE_RATIO: (f32, f32) = (1.0 / 1_048_576.0, 1_048_576.0);

/// The exponents of the law of a texture: from the nearest motion (v0, F0) of the grid to a motion
/// (v, F), frequencies follow `(v / v0)^a` and the level `(v / v0)^b (F / F0)^c`. A filter cannot
/// follow in frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// Exponent a of frequencies over the speed.
    pub frequency_speed: f32,
    /// Exponent b of the level over the speed.
    pub level_speed: f32,
    /// Exponent c of the level over the normal force.
    pub level_force: f32,
}

/// Factors of a texture beyond the grid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factors {
    pub(crate) frequency: f32,
    pub(crate) level: f32,
}

impl Factors {
    /// Those of a motion of the grid.
    pub(crate) const NONE: Self = Self { frequency: 1.0, level: 1.0 };
}

impl Law {
    /// Returns the factors of a motion from the nearest of the grid; both are a speed and a force,
    /// above 0.
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

/// Returns the number of a range that is nearest to a number.
fn within(number: f32, range: (f32, f32)) -> f32 {
    number.max(range.0).min(range.1)
}
