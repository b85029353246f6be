//! The cells of a grid. A cell contains the windows with steady motion around one crossing of the
//! grid's speed and force lines.

use htex_dsp::order;

use super::lines::{FEWEST, Lines};

/// A cell with this many windows is not widened. If this many windows of noise are averaged, their
/// power in third octaves scatters by 0.5 dB (RMS over 17 bands from 20 Hz).
const ENOUGH: usize = 32;
/// Limits for widening a cell. First: a cell may always be widened to speeds within this ratio of
/// its crossing. Second: beyond this ratio, its widths in speed and force may grow by at most these
/// factors.
const WIDENED_RATIO: f64 = 1.19;
const WIDENED: [f64; 2] = [2.0, 1.5];
/// Windows within this distance of a crossing show how the texture changes around it. The unit is
/// the half width of the widest cell.
const SURROUNDINGS: f64 = 2.0;

/// The windows around the crossing of two grid lines.
#[derive(Debug)]
pub(super) struct Cell {
    /// The crossing: logarithms of its speed in mm/s and force in newtons.
    pub(super) at: [f64; 2],
    /// Indices of the windows inside the cell, ascending.
    pub(super) own: Vec<usize>,
    /// Indices of the nearest windows outside the cell, ascending. They fill the cell up to
    /// [`ENOUGH`] windows.
    pub(super) borrowed: Vec<usize>,
    /// Indices of the windows in a wider neighbourhood, including the cell's own.
    pub(super) around: Vec<usize>,
    /// Whether there are windows inside the cell, or borrowed windows at both lower and higher
    /// speeds.
    surrounded: bool,
}

impl Cell {
    /// Returns the windows to average; `None` if there are too few.
    pub(super) fn used(&self) -> Option<Vec<usize>> {
        let all = self.own.len() + self.borrowed.len();
        if !self.surrounded || all < FEWEST {
            return None;
        }
        let mut used: Vec<usize> = self.own.iter().chain(&self.borrowed).copied().collect();
        order::sort(&mut used);
        Some(used)
    }
}

/// Makes the cells of all crossings from the windows whose indices are in `among`. The cells are
/// ordered by speed and then by force.
pub(super) fn gather(lines: &Lines, motions: &[[f64; 2]], among: &[usize]) -> Vec<Cell> {
    let [speeds, forces] = &lines.axes;
    let mut cells = Vec::with_capacity(speeds.len() * forces.len());
    for i in 0..speeds.len() {
        for j in 0..forces.len() {
            let halves = [Lines::halves(speeds, i), Lines::halves(forces, j)];
            cells.push(cell([speeds[i], forces[j]], halves, motions, among));
        }
    }
    cells
}

fn cell(at: [f64; 2], halves: [[f64; 2]; 2], motions: &[[f64; 2]], among: &[usize]) -> Cell {
    let widest = |halves: [f64; 2]| {
        let reach = libm::log(WIDENED_RATIO);
        halves.map(|half| (WIDENED[0] * half).max(reach))
    };
    let wide = [widest(halves[0]), halves[1].map(|half| WIDENED[1] * half)];
    let distances = |halves: [[f64; 2]; 2]| -> Vec<f64> {
        let distance = |motion: &[f64; 2]| distance(at, halves, *motion);
        motions.iter().map(distance).collect()
    };
    let (inside, around) = (distances(halves), distances(wide));
    let all = || among.iter().copied();
    let own: Vec<usize> = all().filter(|i| inside[*i] < 1.0).collect();
    let mut borrowed: Vec<usize> =
        all().filter(|i| inside[*i] >= 1.0 && around[*i] < 1.0).collect();
    // The sort is stable, so that the same windows are chosen on every machine even if distances
    // are equal.
    order::sort_by(&mut borrowed, |a, b| around[*a].total_cmp(&around[*b]));
    borrowed.truncate(ENOUGH.saturating_sub(own.len()));
    order::sort(&mut borrowed);
    let slower = |i: &usize| motions[*i][0] < at[0];
    // If all windows came from one side, this condition would be a copy of its neighbour.
    let both_sides = borrowed.iter().any(slower) && !borrowed.iter().all(slower);
    Cell {
        surrounded: !own.is_empty() || both_sides,
        at,
        own,
        borrowed,
        around: all().filter(|i| around[*i] < SURROUNDINGS).collect(),
    }
}

/// Returns whether there are enough windows for a denser grid: the median cell must have half of
/// [`ENOUGH`].
pub(super) fn are_full(cells: &[Cell]) -> bool {
    let mut counts: Vec<usize> =
        cells.iter().map(|cell| cell.own.len() + cell.borrowed.len()).collect();
    order::sort(&mut counts);
    counts.get(counts.len() / 2).is_some_and(|count| 2 * count >= ENOUGH)
}

/// Returns the distance of a motion from a crossing, in units of the cell's half width: the larger
/// of the distances in speed and force. Below 1 the motion is inside the cell.
fn distance(at: [f64; 2], halves: [[f64; 2]; 2], motion: [f64; 2]) -> f64 {
    let along = |axis: usize| {
        let difference = motion[axis] - at[axis];
        let [below, above] = halves[axis];
        // The lower edge belongs to this cell, and the upper edge belongs to the next cell.
        if difference < 0.0 { -difference / below * (1.0 - 1e-12) } else { difference / above }
    };
    along(0).max(along(1))
}
