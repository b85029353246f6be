//! Small dense least squares: the pseudo-inverse, and a fit that stays above zero.
//!
//! Matrices are row after row.

use alloc::vec::Vec;

/// Sweeps after which Jacobi's method stops; it converges quadratically, in about ten.
const MAX_SWEEPS: usize = 60;

/// Columns count as orthogonal when the cosine between them is below this.
const ORTHOGONAL: f64 = 1e-15;

/// The Moore–Penrose inverse of a matrix, kept to be applied often.
///
/// Singular values up to `max(rows, columns) · 2⁻⁵²` times the largest count as zero, so that empty
/// or dependent rows do no harm.
///
/// ```
/// use htex_dsp::least_squares::PseudoInverse;
/// // One equation, two unknowns: x + y = 4. The smallest solution shares it out.
/// let inverse = PseudoInverse::new(&[1.0, 1.0], 1, 2);
/// let mut x = [0.0; 2];
/// inverse.apply(&[4.0], &mut x);
/// assert!((x[0] - 2.0).abs() < 1e-15 && (x[1] - 2.0).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PseudoInverse {
    /// `columns` rows of `rows` elements.
    inverse: Vec<f64>,
    rows: usize,
    rank: usize,
}

impl PseudoInverse {
    /// Inverts a matrix of `rows` by `columns`; elements missing from `matrix` count as zero.
    pub fn new(matrix: &[f64], rows: usize, columns: usize) -> Self {
        let element = |r: usize, c: usize| matrix.get(r * columns + c).copied().unwrap_or(0.0);
        // The singular vectors are found by turning the shorter side's vectors against each other.
        let wide = rows < columns;
        let vectors: Vec<Vec<f64>> = if wide {
            let row = |r| (0..columns).map(|c| element(r, c)).collect();
            (0..rows).map(row).collect()
        } else {
            let column = |c| (0..rows).map(|r| element(r, c)).collect();
            (0..columns).map(column).collect()
        };
        let factors = Factors::of(vectors);
        let tolerance = rows.max(columns) as f64 * f64::EPSILON * factors.largest();
        let mut inverse = alloc::vec![0.0; rows * columns];
        let mut rank = 0;
        for (long, short) in factors.vectors.iter().zip(&factors.rotation) {
            let sigma = norm(long);
            if sigma <= tolerance {
                continue;
            }
            rank += 1;
            let (by_column, by_row) = if wide { (long, short) } else { (short, long) };
            for (out, c) in inverse.chunks_mut(rows).zip(by_column) {
                for (out, r) in out.iter_mut().zip(by_row) {
                    *out += (c / sigma) * (r / sigma);
                }
            }
        }
        Self {
            inverse,
            rows,
            rank,
        }
    }

    /// Singular values that were not counted as zero.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// `out = pinv(matrix) · values`: `values` has `rows` elements, `out` has `columns`.
    pub fn apply(&self, values: &[f64], out: &mut [f64]) {
        for (out, row) in out.iter_mut().zip(self.inverse.chunks(self.rows.max(1))) {
            *out = row.iter().zip(values).map(|(w, v)| w * v).sum();
        }
    }
}

/// One-sided Jacobi: `vectors` orthogonal, each of length sigma, and the rotation that made them.
struct Factors {
    vectors: Vec<Vec<f64>>,
    rotation: Vec<Vec<f64>>,
}

impl Factors {
    fn of(mut vectors: Vec<Vec<f64>>) -> Self {
        let n = vectors.len();
        let unit = |i: usize| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
        let mut rotation: Vec<Vec<f64>> = (0..n).map(unit).collect();
        for _ in 0..MAX_SWEEPS {
            let mut turned = false;
            for p in 0..n {
                for q in p + 1..n {
                    if let Some((cosine, sine)) = jacobi_rotation(&vectors[p], &vectors[q]) {
                        rotate(&mut vectors, p, q, cosine, sine);
                        rotate(&mut rotation, p, q, cosine, sine);
                        turned = true;
                    }
                }
            }
            if !turned {
                break;
            }
        }
        Self { vectors, rotation }
    }

    /// The largest singular value.
    fn largest(&self) -> f64 {
        self.vectors.iter().map(|v| norm(v)).fold(0.0, f64::max)
    }
}

/// Cosine and sine that make `a` and `b` orthogonal; `None` if they are.
fn jacobi_rotation(a: &[f64], b: &[f64]) -> Option<(f64, f64)> {
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    let limit = ORTHOGONAL * libm::sqrt(aa) * libm::sqrt(bb);
    // False if either is NaN.
    (ab.abs() > limit).then(|| {
        let zeta = (bb - aa) / (2.0 * ab);
        let tangent = libm::copysign(1.0, zeta) / (zeta.abs() + libm::hypot(1.0, zeta));
        let cosine = 1.0 / libm::hypot(1.0, tangent);
        (cosine, cosine * tangent)
    })
}

fn rotate(vectors: &mut [Vec<f64>], p: usize, q: usize, cosine: f64, sine: f64) {
    let (head, tail) = vectors.split_at_mut(q);
    for (x, y) in head[p].iter_mut().zip(&mut tail[0]) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn norm(a: &[f64]) -> f64 {
    libm::sqrt(dot(a, a))
}

/// Least squares over `x >= 0`, by cyclic coordinate descent.
///
/// With more unknowns than equations there are many solutions, and the start decides: from a
/// smooth start the result is smooth.
///
/// ```
/// use htex_dsp::least_squares::NonNegative;
/// let mut x = [1.0, 1.0];
/// NonNegative::new(&[1.0, 0.0, 0.0, 1.0], 2).improve(&mut x, &mut [3.0, -2.0], 100, 1e-12);
/// assert_eq!(x, [3.0, 0.0]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct NonNegative {
    /// The matrix, column after column.
    columns: Vec<f64>,
    rows: usize,
}

impl NonNegative {
    /// Takes a matrix of `columns` columns.
    pub fn new(matrix: &[f64], columns: usize) -> Self {
        let column = |c| matrix.iter().skip(c).step_by(columns.max(1)).copied();
        Self {
            columns: (0..columns).flat_map(column).collect(),
            rows: matrix.len() / columns.max(1),
        }
    }

    /// Improves `x` (one value a column) so that `|matrix · x - rhs|²` falls, until no element
    /// moves by more than `tolerance` times the largest, or `max_sweeps` are done. Returns the
    /// sweeps made; `rhs` (one value a row) is left as the residual. Does not allocate.
    pub fn improve(
        &self,
        x: &mut [f64],
        rhs: &mut [f64],
        max_sweeps: usize,
        tolerance: f64,
    ) -> usize {
        let residual = rhs;
        x.iter_mut().for_each(|x| *x = x.max(0.0));
        for (column, &x) in self.columns.chunks(self.rows.max(1)).zip(x.iter()) {
            subtract(residual, column, x);
        }
        for sweep in 1..=max_sweeps {
            let (moved, largest) = self.sweep(x, residual);
            if moved <= tolerance * largest {
                return sweep;
            }
        }
        max_sweeps
    }

    /// Moves every element once; the largest move, and the largest element.
    fn sweep(&self, x: &mut [f64], residual: &mut [f64]) -> (f64, f64) {
        let (mut moved, mut largest) = (0.0_f64, 0.0_f64);
        for (column, x) in self.columns.chunks(self.rows.max(1)).zip(x.iter_mut()) {
            let step = dot(column, residual) / dot(column, column);
            let target = if step.is_finite() {
                (*x + step).max(0.0)
            } else {
                *x
            };
            subtract(residual, column, target - *x);
            moved = moved.max((target - *x).abs());
            *x = target;
            largest = largest.max(target);
        }
        (moved, largest)
    }
}

fn subtract(residual: &mut [f64], column: &[f64], factor: f64) {
    for (r, c) in residual.iter_mut().zip(column) {
        *r -= factor * c;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn product(matrix: &[f64], columns: usize, x: &[f64]) -> Vec<f64> {
        matrix.chunks(columns).map(|row| dot(row, x)).collect()
    }

    #[test]
    fn dependent_and_empty_rows_do_no_harm() {
        let matrix = [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 0.0];
        let inverse = PseudoInverse::new(&matrix, 3, 3);
        assert_eq!(inverse.rank(), 1);
        let mut x = [0.0; 3];
        inverse.apply(&[14.0, 28.0, 5.0], &mut x);
        for (x, expected) in x.iter().zip([1.0, 2.0, 3.0]) {
            assert!((x - expected).abs() < 1e-12);
        }
        assert_eq!(PseudoInverse::new(&[0.0; 6], 2, 3).rank(), 0);
        assert_eq!(PseudoInverse::new(&[], 0, 0).rank(), 0);
    }

    #[test]
    fn tall_systems_are_solved_in_the_least_squares_sense() {
        // A line through (0, 1), (1, 3), (2, 5), (3, 7).
        let matrix = [1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 3.0];
        let mut x = [0.0; 2];
        PseudoInverse::new(&matrix, 4, 2).apply(&[1.0, 3.0, 5.0, 7.0], &mut x);
        assert!((x[0] - 1.0).abs() < 1e-13 && (x[1] - 2.0).abs() < 1e-13);
    }

    #[test]
    fn a_wide_nonnegative_fit_meets_reachable_energies() {
        let matrix = [1.0, 0.5, 0.0, 0.0, 0.0, 0.5, 1.0, 0.5];
        let mut x = [0.0; 4];
        NonNegative::new(&matrix, 4).improve(&mut x, &mut [1.0, 3.0], 10_000, 1e-14);
        let reached = product(&matrix, 4, &x);
        assert!((reached[0] - 1.0).abs() < 1e-9 && (reached[1] - 3.0).abs() < 1e-9);
        assert!(x.iter().all(|&x| x >= 0.0));
    }
}
