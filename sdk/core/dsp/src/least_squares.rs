//! Solves small dense least-squares problems with the pseudo-inverse.
//!
//! Matrices are stored row by row.

use alloc::vec::Vec;

/// Maximum number of Jacobi sweeps. The method converges quadratically, in about ten sweeps.
const MAX_SWEEPS: usize = 60;

/// Columns count as orthogonal if the cosine of the angle between them is below this.
const ORTHOGONAL: f64 = 1e-15;

/// The Moore–Penrose inverse of a matrix, stored for repeated use.
///
/// Singular values up to `max(rows, columns) · 2⁻⁵²` times the largest singular value count as
/// zero, so zero or dependent rows are allowed.
///
/// ```
/// use htex_dsp::least_squares::PseudoInverse;
/// // One equation, two unknowns: x + y = 4. The solution of least norm has x = y.
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
    /// Inverts a matrix of `rows` by `columns`. Elements missing from `matrix` count as zero.
    pub fn new(matrix: &[f64], rows: usize, columns: usize) -> Self {
        let element = |r: usize, c: usize| matrix.get(r * columns + c).copied().unwrap_or(0.0);
        // Takes the rows or the columns, whichever are fewer, and rotates pairs of them until all
        // are orthogonal.
        let wide = rows < columns;
        let vectors: Vec<Vec<f64>> = if wide {
            let row = |r| (0..columns).map(|c| element(r, c)).collect();
            (0..rows).map(row).collect()
        } else {
            let column = |c| (0..rows).map(|r| element(r, c)).collect();
            (0..columns).map(column).collect()
        };
        let factors = Factors::new(vectors);
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
                    // Each factor is divided separately, because the square of `sigma` could
                    // overflow or underflow.
                    *out += (c / sigma) * (r / sigma);
                }
            }
        }
        Self { inverse, rows, rank }
    }

    /// Number of singular values that do not count as zero.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Writes `out = pinv(matrix) · values`. `values` has `rows` elements, `out` has `columns`.
    pub fn apply(&self, values: &[f64], out: &mut [f64]) {
        for (out, row) in out.iter_mut().zip(self.inverse.chunks(self.rows.max(1))) {
            *out = row.iter().zip(values).map(|(w, v)| w * v).sum();
        }
    }
}

/// Result of the one-sided Jacobi method: orthogonal `vectors`, whose lengths are the singular
/// values, and the rotation that makes them.
struct Factors {
    vectors: Vec<Vec<f64>>,
    rotation: Vec<Vec<f64>>,
}

impl Factors {
    fn new(mut vectors: Vec<Vec<f64>>) -> Self {
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

/// Returns the cosine and sine of the rotation that makes `a` and `b` orthogonal, or `None` if they
/// already are orthogonal.
fn jacobi_rotation(a: &[f64], b: &[f64]) -> Option<(f64, f64)> {
    let (aa, bb, ab) = (dot(a, a), dot(b, b), dot(a, b));
    // Each square has its own root, because the product of the squares could overflow or underflow.
    let limit = ORTHOGONAL * crate::root::sqrt(aa) * crate::root::sqrt(bb);
    // This comparison is false if either side is NaN.
    (ab.abs() > limit).then(|| {
        let zeta = (bb - aa) / (2.0 * ab);
        // The smaller of the two possible angles, at most an eighth of a turn. With the larger one
        // the sweeps might not converge.
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
    crate::root::sqrt(dot(a, a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependent_and_zero_rows_are_handled() {
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
        // The line through the points (0, 1), (1, 3), (2, 5) and (3, 7).
        let matrix = [1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 3.0];
        let mut x = [0.0; 2];
        PseudoInverse::new(&matrix, 4, 2).apply(&[1.0, 3.0, 5.0, 7.0], &mut x);
        assert!((x[0] - 1.0).abs() < 1e-13 && (x[1] - 2.0).abs() < 1e-13);
    }
}
