//! Weights with which a motion mixes the conditions of the grid.

use crate::words::Words;

/// Up to four conditions of the grid, with their bilinear weights.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Weights {
    of: [(usize, f32); 4],
}

impl Weights {
    /// Computes the weights of the four corners around a motion within the grid. The conditions are
    /// ordered such that the speed varies fastest.
    pub(crate) fn new(speeds: Words<'_>, forces: Words<'_>, speed: f32, force: f32) -> Self {
        let (s, u) = place(speeds, speed);
        let (f, v) = place(forces, force);
        let columns = speeds.len();
        let at = |speed: usize, force: usize| force * columns + speed;
        Self {
            of: [
                (at(s, f), (1.0 - u) * (1.0 - v)),
                (at(s + 1, f), u * (1.0 - v)),
                (at(s, f + 1), (1.0 - u) * v),
                (at(s + 1, f + 1), u * v),
            ],
        }
    }

    /// Returns the conditions with a weight above zero.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, f32)> + '_ {
        // A corner beyond the end of an axis always has weight 0, so its index is never used.
        self.of.iter().copied().filter(|(_, weight)| *weight > 0.0)
    }
}

/// Finds the place of a number on an ascending axis. Returns the index of the value below the
/// number, and the position of the number between this value and the next one, from 0 to 1.
fn place(axis: Words<'_>, value: f32) -> (usize, f32) {
    let above = axis.iter().take_while(|x| *x <= value).count();
    if above == 0 {
        return (0, 0.0);
    }
    let below = above - 1;
    if above >= axis.len() {
        return (below, 0.0);
    }
    let (low, high) = (axis.get(below), axis.get(above));
    (below, (value - low) / (high - low))
}
