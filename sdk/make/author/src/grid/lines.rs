//! The lines of a grid, i.e. its speeds and forces. The user gives the lines, or this module
//! chooses them from the motions of the steady windows.

use super::request::Grid;
use crate::AuthorError;
use crate::findings::quantile;

/// Fewest windows of a condition, including windows that its cell borrows from neighbouring cells.
pub(super) const FEWEST: usize = 8;
/// A chosen grid covers the windows' speeds and forces between these two quantiles.
const COVERED: [f64; 2] = [0.01, 0.99];
/// Largest ratio of neighbouring forces in a chosen grid. The level changes smoothly with the
/// force, and players interpolate it linearly.
const FORCE_RATIO: f64 = 4.0;
/// A speed or force counts as constant if its highest value is at most this many times the lowest.
const CONSTANT: f64 = 1.15;
/// Distance of the outermost lines from the ends of the covered range, in line spacings.
const MARGIN: f64 = 0.25;
/// Half the width of the cells of a single line, as a ratio.
const SINGLE: f64 = 1.25;

/// The lines of both axes, as logarithms of mm/s and of newtons, ascending.
pub(super) struct Lines {
    pub(super) axes: [Vec<f64>; 2],
}

impl Lines {
    /// Returns the given lines. If an axis has no given lines, chooses lines for it. Chosen lines
    /// are equally spaced in the logarithm, over the range that contains 98 % of the windows. The
    /// function chooses the smallest number of lines for which the ratio of neighbouring speeds is
    /// at most `speed_ratio`, and the ratio of neighbouring forces is at most 4.
    pub(super) fn choose(
        grid: &Grid,
        motions: &[[f64; 2]],
        speed_ratio: f64,
    ) -> Result<Self, AuthorError> {
        let given = |lines: &Option<Vec<f64>>| {
            let logs = |lines: &Vec<f64>| lines.iter().map(|x| libm::log(*x)).collect();
            lines.as_ref().map(logs)
        };
        let (speeds, forces) = (given(&grid.speed_mm_s), given(&grid.force_n));
        if motions.len() < FEWEST {
            return Err(AuthorError::GridFew { segments: motions.len(), needed: FEWEST });
        }
        let [speed, force] = [0, 1].map(|axis| LogRange::of_motions(motions, axis));
        if speed.is_constant() && force.is_constant() && speeds.is_none() && forces.is_none() {
            return Err(AuthorError::GridConstant {
                speed_mm_s: [speed.low, speed.high].map(libm::exp),
                force_n: [force.low, force.high].map(libm::exp),
            });
        }
        Ok(Self {
            axes: [
                speeds.unwrap_or_else(|| speed.at_most(speed_ratio)),
                forces.unwrap_or_else(|| force.at_most(FORCE_RATIO)),
            ],
        })
    }

    /// Returns half the distance from a line to its neighbours below and above. An outermost line
    /// has only one neighbour, so both values are half the distance to this neighbour. A line
    /// without neighbours has `log(SINGLE)` on both sides.
    pub(super) fn halves(lines: &[f64], i: usize) -> [f64; 2] {
        let half = |a: Option<&f64>, b: Option<&f64>| Some(0.5 * (b? - a?));
        let below = half(i.checked_sub(1).and_then(|k| lines.get(k)), lines.get(i));
        let above = half(lines.get(i), lines.get(i + 1));
        let single = libm::log(SINGLE);
        [below.or(above).unwrap_or(single), above.or(below).unwrap_or(single)]
    }
}

/// The range of speed or force that a chosen grid covers, as logarithms.
struct LogRange {
    low: f64,
    high: f64,
}

impl LogRange {
    fn of_motions(motions: &[[f64; 2]], axis: usize) -> Self {
        let at = |part| quantile(part, motions.len(), |i| motions[i][axis]).unwrap_or(0.0);
        let [low, high] = COVERED.map(at);
        Self { low, high }
    }

    fn is_constant(&self) -> bool {
        self.high - self.low < libm::log(CONSTANT)
    }

    /// Returns the smallest number of lines with which the ratio between neighbours is at most
    /// `ratio`.
    fn at_most(&self, ratio: f64) -> Vec<f64> {
        if self.is_constant() {
            return self.lines(1);
        }
        let spacings = (self.high - self.low) / libm::log(ratio);
        // The margins at both ends cover part of the range. The small number absorbs rounding.
        let count = libm::ceil(spacings + 1.0 - 2.0 * MARGIN - 1e-9);
        self.lines((count as usize).max(2))
    }

    /// Returns equally spaced lines; a single line is in the middle.
    fn lines(&self, count: usize) -> Vec<f64> {
        if count < 2 {
            return vec![0.5 * (self.low + self.high)];
        }
        let spacing = (self.high - self.low) / (count as f64 - 1.0 + 2.0 * MARGIN);
        (0..count).map(|i| self.low + (MARGIN + i as f64) * spacing).collect()
    }
}
