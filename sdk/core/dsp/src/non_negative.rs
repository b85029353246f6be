//! Finds non-negative power spectra that have given energies in triangular filters.
//!
//! With fewer bands than bins, least squares has many solutions. A ridge term of 10^-6 makes the
//! solution unique. Newton's method finds this solution in a few steps with a tridiagonal matrix.
//! Any other solver of non-negative least squares would find the same solution.

use alloc::vec::Vec;

use crate::triangles::TriangleBank;

/// Weight of the ridge term, which is the squared norm of the power. It makes the solution unique.
/// If a spectrum with the wanted energies exists, the solution's energies differ from them by about
/// a millionth.
pub(crate) const RIDGE: f64 = 1e-6;
/// Maximum number of Newton steps; energies of recordings need three to eight.
const STEPS: usize = 100;
/// Maximum number of halvings of a step.
const HALVINGS: usize = 40;
/// Relative slope that counts as zero: slope along a step, divided by the slope at its start.
const FLAT: f64 = 1e-9;

/// Finds the powers `p >= 0` that minimise `|W p - e|² + RIDGE |p|²` for a bank `W` of triangular
/// filters and energies `e`. The solution is unique.
///
/// The solution has the form `p = max(0, Wᵀ s)`. The vector `s` contains one number per filter and
/// solves `RIDGE s + W max(0, Wᵀ s) = e`. This equation is piecewise linear, so Newton's method is
/// exact on each piece. The matrix of Newton's method is tridiagonal, because only neighbouring
/// filters overlap.
///
/// ```
/// use htex_dsp::non_negative::{NonNegative, Scratch};
/// use htex_dsp::triangles::TriangleBank;
/// let bank = TriangleBank::new(&[0.0, 1.0, 2.0, 3.0], &[1.0, 1.5, 2.0]);
/// let (mut power, mut scratch) = ([0.0; 3], Scratch::new(2));
/// NonNegative::new(&bank).solve(&[1.0, 0.0], &mut power, &mut scratch);
/// assert!((power[0] - 1.0).abs() < 1e-5 && power[2] == 0.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct NonNegative {
    columns: Vec<Column>,
    rows: usize,
}

/// Weights of one frequency: in the filter `first` and in the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Column {
    first: usize,
    weight: [f64; 2],
}

/// Working memory of [`NonNegative::solve`] for a given number of filters.
#[derive(Debug, Clone)]
pub struct Scratch {
    wanted: Vec<f64>,
    /// The current solution, and the next step from it.
    at: Vec<f64>,
    step: Vec<f64>,
    residual: Vec<f64>,
    diagonal: Vec<f64>,
    beside: Vec<f64>,
}

impl Scratch {
    /// Memory for `rows` filters.
    pub fn new(rows: usize) -> Self {
        let zeros = || alloc::vec![0.0; rows];
        Self {
            wanted: zeros(),
            at: zeros(),
            step: zeros(),
            residual: zeros(),
            diagonal: zeros(),
            beside: zeros(),
        }
    }
}

impl NonNegative {
    /// Creates a solver with a copy of a filter bank's weights.
    pub fn new(bank: &TriangleBank) -> Self {
        let rows = bank.rows();
        let column = |c: usize| {
            let first = (0..rows).find(|&row| bank.weight(row, c) > 0.0).unwrap_or(0);
            let weight = [first, first + 1].map(|row| bank.weight(row, c));
            Column { first, weight }
        };
        Self { columns: (0..bank.columns()).map(column).collect(), rows }
    }

    /// Writes the power spectrum for these `energies`, which must not be negative. `scratch` must
    /// be made for the same number of filters. The energy of a filter without weights is ignored.
    /// Does not allocate.
    pub fn solve(&self, energies: &[f64], power: &mut [f64], scratch: &mut Scratch) {
        let largest = energies.iter().copied().fold(0.0, f64::max);
        self.start(energies, largest, scratch);
        for _ in 0..STEPS {
            if !self.advance(scratch) {
                break;
            }
        }
        for (power, column) in power.iter_mut().zip(&self.columns) {
            *power = largest * column.between(&scratch.at).max(0.0);
        }
    }

    /// Scales the energies by the largest one. The starting point is the solution without the
    /// constraint.
    fn start(&self, energies: &[f64], largest: f64, scratch: &mut Scratch) {
        scratch.wanted.fill(0.0);
        for column in &self.columns {
            for (row, weight) in (column.first..).zip(column.weight) {
                if weight > 0.0 {
                    // If all energies are zero, the quotient is NaN. Then the search ends at once,
                    // and `max` in `solve` turns the power into 0.
                    scratch.wanted[row] = energies[row] / largest;
                }
            }
        }
        scratch.derive(&self.columns, |_| true);
        scratch.at.copy_from_slice(&scratch.wanted);
        solve_tridiagonal(&mut scratch.diagonal, &scratch.beside, &mut scratch.at);
    }

    /// Makes one Newton step, halved until the slope along it is no longer positive. Returns false
    /// at the solution.
    fn advance(&self, scratch: &mut Scratch) -> bool {
        scratch.measure(&self.columns, 0.0);
        let Scratch { residual, step, .. } = scratch;
        for (step, residual) in step.iter_mut().zip(&*residual) {
            *step = -residual;
        }
        scratch.derive_here(&self.columns);
        solve_tridiagonal(&mut scratch.diagonal, &scratch.beside, &mut scratch.step);
        let slope = scratch.slope();
        // The condition is written in this form so that a NaN slope also ends the search.
        if !matches!(slope.partial_cmp(&0.0), Some(core::cmp::Ordering::Less)) {
            return false;
        }
        let mut part = 1.0;
        for _ in 0..HALVINGS {
            scratch.measure(&self.columns, part);
            if scratch.slope() <= -FLAT * slope {
                break;
            }
            part *= 0.5;
        }
        let mut moved = false;
        for (at, step) in scratch.at.iter_mut().zip(&scratch.step) {
            let next = *at + part * step;
            moved |= (next - *at).abs() > 1e-14 * next.abs();
            *at = next;
        }
        moved
    }

    /// Number of filters.
    pub fn rows(&self) -> usize {
        self.rows
    }
}

impl Column {
    /// `Wᵀ s` at this frequency.
    fn between(&self, values: &[f64]) -> f64 {
        let next = values.get(self.first + 1).copied().unwrap_or(0.0);
        self.weight[0] * values[self.first] + self.weight[1] * next
    }
}

impl Scratch {
    /// Computes the residual at `at + part * step`.
    fn measure(&mut self, columns: &[Column], part: f64) {
        for i in 0..self.at.len() {
            let s = self.at[i] + part * self.step[i];
            self.residual[i] = RIDGE * s - self.wanted[i];
        }
        for column in columns {
            let power = column.between(&self.at) + part * column.between(&self.step);
            if power > 0.0 {
                for (row, weight) in (column.first..).zip(column.weight) {
                    if weight > 0.0 {
                        self.residual[row] += weight * power;
                    }
                }
            }
        }
    }

    /// Slope of the cost along the step.
    fn slope(&self) -> f64 {
        self.residual.iter().zip(&self.step).map(|(r, d)| r * d).sum()
    }

    /// Derivative of the residual at the current solution.
    fn derive_here(&mut self, columns: &[Column]) {
        // `at` is taken out, because `derive` borrows all of `self`. An empty vector is put in its
        // place, without an allocation.
        let at = core::mem::take(&mut self.at);
        self.derive(columns, |column| column.between(&at) > 0.0);
        self.at = at;
    }

    /// Derivative of the residual, over the frequencies for which `active` is true.
    fn derive(&mut self, columns: &[Column], active: impl Fn(&Column) -> bool) {
        self.diagonal.fill(RIDGE);
        self.beside.fill(0.0);
        for column in columns.iter().filter(|column| active(column)) {
            let [here, next] = column.weight;
            self.diagonal[column.first] += here * here;
            // The last filter has no next one. Its second weight is 0, which keeps the index in
            // range.
            if next > 0.0 {
                self.diagonal[column.first + 1] += next * next;
                self.beside[column.first] += here * next;
            }
        }
    }
}

/// Solves a symmetric positive definite tridiagonal system in place. `beside[i]` is the element
/// that couples `i` and `i + 1`.
fn solve_tridiagonal(diagonal: &mut [f64], beside: &[f64], values: &mut [f64]) {
    for i in 1..values.len() {
        // The ridge term makes the matrix positive definite, so no pivoting is needed.
        let ratio = beside[i - 1] / diagonal[i - 1];
        diagonal[i] -= ratio * beside[i - 1];
        values[i] -= ratio * values[i - 1];
    }
    let mut behind = 0.0;
    for i in (0..values.len()).rev() {
        values[i] = (values[i] - beside[i] * behind) / diagonal[i];
        behind = values[i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Band;
    use crate::mel::MelBank;
    use crate::uniform::Uniform;

    /// Tests the optimality conditions of a convex cost: the gradient is zero where the power is
    /// positive, and not negative where the power is zero.
    #[test]
    fn the_solution_is_the_minimum() {
        let grid = Band::TACTILE.grid_hz();
        let mut uniform = Uniform::new(7);
        for bands in [2, 9, 26, 60, 128] {
            let mel = MelBank::new(bands, Band::TACTILE, &grid);
            let (solver, mut scratch) = (NonNegative::new(mel.filters()), Scratch::new(bands));
            let mut power = alloc::vec![0.0; grid.len()];
            for round in 0..20 {
                // The energies are up to 100 dB apart. No spectrum reaches most of them.
                let spread = f64::from(round);
                let energies: Vec<f64> =
                    (0..bands).map(|_| libm::exp(spread * uniform.next_unit())).collect();
                solver.solve(&energies, &mut power, &mut scratch);
                let reached = mel.energies(&power);
                let largest = energies.iter().copied().fold(0.0, f64::max);
                for (column, &p) in power.iter().enumerate() {
                    let pull: f64 = (0..bands)
                        .map(|row| {
                            mel.filters().weight(row, column) * (energies[row] - reached[row])
                        })
                        .sum();
                    let gradient = (RIDGE * p - pull) / largest;
                    assert!(p >= 0.0 && gradient > -1e-10, "{bands} {round}: {gradient}");
                    assert!(p == 0.0 || gradient < 1e-10, "{bands} {round}: {gradient}");
                }
            }
        }
    }
}
