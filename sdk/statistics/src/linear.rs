//! Linear algebra: determinants of symmetric matrices, and least squares.

/// Returns the logarithm of the determinant of a symmetric matrix, by Cholesky; `None` unless it is positive definite, beyond rounding.
pub(crate) fn log_determinant(matrix: &[Vec<f64>]) -> Option<f64> {
    let size = matrix.len();
    let mut lower = vec![vec![0.0; size]; size];
    let mut sum = 0.0;
    for i in 0..size {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = matrix[i][j] - dot;
            if i > j {
                lower[i][j] = rest / lower[j][j];
                continue;
            }
            if rest <= 1e-12 * matrix[i][i] || rest.is_nan() {
                return None;
            }
            lower[i][i] = libm::sqrt(rest);
            sum += libm::log(rest);
        }
    }
    Some(sum)
}

/// The solution of a least-squares problem.
pub(crate) struct LeastSquares {
    /// A coefficient for each column; 0 for columns that depend on those before them.
    pub(crate) coefficients: Vec<f64>,
    /// Indices of the columns that depend on those before them.
    pub(crate) dependent: Vec<usize>,
}

/// Finds the coefficients of `columns` that are closest to `target`, by Householder's QR (Golub and Van Loan 2013, section 5.2).
///
/// A column whose part orthogonal to those before it is only rounding gets the coefficient 0.
pub(crate) fn least_squares(columns: &[Vec<f64>], target: &[f64]) -> LeastSquares {
    let mut reflections: Vec<Vec<f64>> = Vec::new();
    let mut upper: Vec<Vec<f64>> = Vec::new();
    let (mut used, mut dependent) = (Vec::new(), Vec::new());
    for (index, column) in columns.iter().enumerate() {
        let rank = reflections.len();
        let mut rest = column.clone();
        reflect_all(&reflections, &mut rest);
        let size = norm(&rest[rank.min(rest.len())..]);
        if rank >= rest.len() || size <= 1e-11 * norm(column) || size == 0.0 {
            dependent.push(index);
            continue;
        }
        let diagonal = if rest[rank] > 0.0 { -size } else { size };
        let mut reflection = vec![0.0; rest.len()];
        reflection[rank..].copy_from_slice(&rest[rank..]);
        reflection[rank] -= diagonal;
        let length = norm(&reflection);
        reflection.iter_mut().for_each(|v| *v /= length);
        reflections.push(reflection);
        rest.truncate(rank);
        rest.push(diagonal);
        upper.push(rest);
        used.push(index);
    }
    let mut rotated = target.to_vec();
    reflect_all(&reflections, &mut rotated);
    let mut coefficients = vec![0.0; columns.len()];
    for (k, value) in back_substitute(&upper, &rotated).into_iter().enumerate() {
        coefficients[used[k]] = value;
    }
    LeastSquares {
        coefficients,
        dependent,
    }
}

/// The upper triangle that a matrix of these columns becomes by Householder's QR: least squares on it have the same solution. It has at most
/// as many rows as columns.
pub(crate) fn triangle(mut columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let rows = columns.first().map_or(0, Vec::len);
    let most = rows.min(columns.len());
    for k in 0..most {
        let mut reflection = columns[k][k..].to_vec();
        let size = norm(&reflection);
        if size == 0.0 {
            continue;
        }
        reflection[0] += if reflection[0] > 0.0 { size } else { -size };
        let length = norm(&reflection);
        reflection.iter_mut().for_each(|v| *v /= length);
        for column in &mut columns[k..] {
            let twice = 2.0 * dot(&reflection, &column[k..]);
            let pairs = column[k..].iter_mut().zip(&reflection);
            pairs.for_each(|(v, r)| *v -= twice * r);
        }
        // Zero but for rounding.
        columns[k][k + 1..].fill(0.0);
    }
    columns.iter_mut().for_each(|column| column.truncate(most));
    columns
}

fn reflect_all(reflections: &[Vec<f64>], vector: &mut [f64]) {
    for reflection in reflections {
        let twice = 2.0 * dot(reflection, vector);
        let pairs = vector.iter_mut().zip(reflection);
        pairs.for_each(|(v, r)| *v -= twice * r);
    }
}

/// Solves an upper triangular system, whose columns are given down to the diagonal.
fn back_substitute(upper: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let rank = upper.len();
    let mut solution = vec![0.0; rank];
    for i in (0..rank).rev() {
        let known: f64 = (i + 1..rank).map(|j| upper[j][i] * solution[j]).sum();
        solution[i] = (right[i] - known) / upper[i][i];
    }
    solution
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn norm(values: &[f64]) -> f64 {
    libm::sqrt(dot(values, values))
}
