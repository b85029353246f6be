//! The grid of baked conditions.

use crate::{Error, Motion, Representation};
use htex_player::layout::{
    LEAST_FORCE_N, MIN_SLIDING_MM_S, MOST_FORCE_N, MOST_ON_AXIS, MOST_SPEED_MM_S,
};

/// The conditions of a baked block: speeds and forces. The block has a condition for each
/// combination of a speed and a force.
///
/// ```
/// use htex_play::bake::Grid;
/// let grid = Grid::new(vec![160.0, 40.0], vec![0.4])?;
/// assert_eq!(grid.speeds_mm_s(), [40.0, 160.0]);
/// assert!(Grid::new(vec![0.0], vec![0.4]).is_err());
/// # Ok::<(), htex_play::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    speeds_mm_s: Vec<f64>,
    forces_n: Vec<f64>,
}

impl Grid {
    /// Makes a grid from speeds (mm/s) and forces (newtons), which may be given in any order.
    /// Values are rounded to single precision.
    ///
    /// # Errors
    /// Returns an error if an axis is empty or has more than 32 different values. Also returns an
    /// error if a speed is outside 0.5 to 1000 mm/s, or a force is outside 1e-6 to 20 N.
    pub fn new(speeds_mm_s: Vec<f64>, forces_n: Vec<f64>) -> Result<Self, Error> {
        Ok(Self {
            speeds_mm_s: axis("the speeds", [MIN_SLIDING_MM_S, MOST_SPEED_MM_S], speeds_mm_s)?,
            forces_n: axis("the forces", [LEAST_FORCE_N, MOST_FORCE_N], forces_n)?,
        })
    }

    /// Makes a grid from a list of conditions.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::new`]. Also returns an error if a combination of the
    /// speeds and forces is missing.
    pub fn from_conditions(at: &[Motion]) -> Result<Self, Error> {
        let grid = Self::new(
            at.iter().map(|m| m.speed_mm_s).collect(),
            at.iter().map(|m| m.force_n).collect(),
        )?;
        // Motions are compared as the grid stores them, in single precision.
        let is_there = |wanted: &Motion| {
            at.iter().any(|m| {
                m.speed_mm_s as f32 == wanted.speed_mm_s as f32
                    && m.force_n as f32 == wanted.force_n as f32
            })
        };
        let absent = grid.motions().find(|wanted| !is_there(wanted));
        match absent {
            Some(Motion { speed_mm_s, force_n, .. }) => {
                Err(Error::Incomplete { speed_mm_s, force_n })
            }
            None => Ok(grid),
        }
    }

    /// Makes a grid of a single condition: the default condition of a representation
    /// ([`Representation::default_condition`]). If the condition does not state a speed, 80 mm/s is
    /// used. If the condition does not state a force, 0.4 N is used.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::new`].
    pub fn for_default_condition(representation: Representation<'_>) -> Result<Self, Error> {
        Self::from_conditions(&[representation.motion(None, None)])
    }

    /// Returns the speeds, mm/s, ascending.
    pub fn speeds_mm_s(&self) -> &[f64] {
        &self.speeds_mm_s
    }

    /// Returns the forces, newtons, ascending.
    pub fn forces_n(&self) -> &[f64] {
        &self.forces_n
    }

    /// Returns all conditions in the order of a block, in which the speed varies fastest.
    pub fn motions(&self) -> impl Iterator<Item = Motion> + '_ {
        let at = |force: f64| move |&speed: &f64| Motion::new(speed, force);
        let forces = self.forces_n.iter();
        forces.flat_map(move |&force| self.speeds_mm_s.iter().map(at(force)))
    }

    /// Adds speeds and forces to the grid, and returns the new grid. They are the speeds and forces
    /// of the motions whose error exceeds `within_db`. An axis stays unchanged if it would get more
    /// than 32 values.
    pub(crate) fn refined(&self, errors: &[(Motion, f64)], within_db: f64) -> Self {
        let worst = || errors.iter().filter(|(_, error)| *error > within_db);
        let axis = |own: &[f64], more: Vec<f64>| {
            let mut all: Vec<f64> = own.iter().copied().chain(more).collect();
            // In single precision a midpoint may equal one of its neighbours.
            all = all.iter().map(|x| f64::from(*x as f32)).collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            if all.len() <= MOST_ON_AXIS { all } else { own.to_vec() }
        };
        // The midpoints of a cell's edges are added first, because they may also reduce the error
        // at the centre of the cell.
        let on = |axis: &[f64], x: f64| axis.contains(&x);
        let speeds = worst().filter(|(m, _)| on(&self.forces_n, m.force_n));
        let forces = worst().filter(|(m, _)| on(&self.speeds_mm_s, m.speed_mm_s));
        let refined = Self {
            speeds_mm_s: axis(&self.speeds_mm_s, speeds.map(|(m, _)| m.speed_mm_s).collect()),
            forces_n: axis(&self.forces_n, forces.map(|(m, _)| m.force_n).collect()),
        };
        if refined != *self {
            return refined;
        }
        // Only centres of cells are left. Adding their speeds makes them midpoints of edges, for
        // which the next round can add a force.
        Self {
            speeds_mm_s: axis(&self.speeds_mm_s, worst().map(|(m, _)| m.speed_mm_s).collect()),
            forces_n: self.forces_n.clone(),
        }
    }

    /// Returns the centre of each cell, and of each edge between neighbours. Each centre comes with
    /// the indices of the conditions that are mixed there in equal parts.
    pub(crate) fn midpoints(&self) -> Vec<(Motion, Vec<usize>)> {
        let columns = self.speeds_mm_s.len();
        let mut all = Vec::new();
        for (j, forces) in spans(&self.forces_n) {
            for (i, speeds) in spans(&self.speeds_mm_s) {
                // A single speed and a single force are a condition, not a midpoint.
                if forces.len() + speeds.len() == 2 {
                    continue;
                }
                let rows = (j..j + forces.len()).map(|row| row * columns);
                let mixed = rows.flat_map(|row| (i..i + speeds.len()).map(move |at| row + at));
                all.push((Motion::new(mean(speeds), mean(forces)), mixed.collect()));
            }
        }
        all
    }
}

/// Returns each single value and each pair of neighbours, each with the index of its first value.
fn spans(axis: &[f64]) -> impl Iterator<Item = (usize, &[f64])> {
    let single = axis.chunks(1).enumerate();
    single.chain(axis.windows(2).enumerate())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn axis(axis: &'static str, range: [f32; 2], values: Vec<f64>) -> Result<Vec<f64>, Error> {
    // A block stores single precision, so the range is checked after rounding.
    let mut rounded: Vec<f64> = values.iter().map(|x| f64::from(*x as f32)).collect();
    let [least, largest] = range.map(f64::from);
    let in_range = rounded.iter().all(|x| (least..=largest).contains(x));
    rounded.sort_by(f64::total_cmp);
    rounded.dedup();
    if in_range && (1..=MOST_ON_AXIS).contains(&rounded.len()) {
        Ok(rounded)
    } else {
        Err(Error::Axis { axis, values, most: MOST_ON_AXIS, least, largest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn midpoints_lie_between_all_neighbours() {
        let grid = Grid::new(vec![40.0, 80.0], vec![0.2, 0.5]).unwrap();
        let mixed: Vec<Vec<usize>> = grid.midpoints().into_iter().map(|(_, of)| of).collect();
        assert_eq!(mixed.len(), 5);
        for of in [vec![0, 1], vec![2, 3], vec![0, 2], vec![1, 3], vec![0, 1, 2, 3]] {
            assert!(mixed.contains(&of), "{of:?} in {mixed:?}");
        }
    }

    #[test]
    fn listed_conditions_are_all_combinations() {
        let [a, b, c] = [(40.0, 0.2), (80.0, 0.2), (40.0, 0.5)].map(|(s, f)| Motion::new(s, f));
        assert!(Grid::from_conditions(&[a, b]).is_ok());
        let absent = Grid::from_conditions(&[a, b, c]).unwrap_err();
        assert!(matches!(absent, Error::Incomplete { speed_mm_s: 80.0, .. }), "{absent}");
    }
}
