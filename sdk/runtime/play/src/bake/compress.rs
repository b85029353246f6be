//! Compression of filters: the filter of each condition becomes a weighted sum of a few common
//! filters.
//!
//! The filters of the conditions are projected on the leading eigenvectors of the matrix of their
//! inner products. An inner product is the sum, over all frequencies, of the product of two
//! filters' responses, weighted by the mean inverse power at each frequency. Because of this
//! weight, an error counts as much in a faint frequency band as in a loud band. Projection is
//! linear. For a motion between conditions, the player can therefore mix the projected filters with
//! the same weights as the original filters. Weights and coefficients are stored as 16-bit integers
//! with a scale.

use std::ops::RangeInclusive;

use crate::bake::filter::Design;

/// Floor of the power in the weights, relative to the strongest frequency: 20 dB below it. A
/// frequency with less power gets no larger weight. Of the floors 50, 40, 30, 20 and 10 dB, this
/// one needs the fewest filters.
const FLOOR: f64 = 1e-2;
/// The search for independent filters ends when at most this part of the energy is left.
const NOTHING: f64 = 1e-14;
/// Maximum number of sweeps of rotations. Ten are enough for matrices of this size.
const SWEEPS: usize = 30;
const LARGEST: f64 = 32_767.0;

/// Common filters, and the weights with which the conditions mix them. The most important filter
/// comes first.
pub(crate) struct Factors {
    /// The weights of each filter, one for each condition.
    weights: Vec<Vec<f64>>,
    filters: Vec<Vec<f64>>,
}

/// Filters as a block stores them.
#[derive(Clone)]
pub(crate) struct StoredFilters {
    pub(crate) scales: Vec<f32>,
    /// The weights of all filters for the first condition, then for the next condition, and so on.
    pub(crate) weights: Vec<i16>,
    pub(crate) filters: Vec<Vec<i16>>,
}

impl Factors {
    /// Factors the filters of all conditions into at most `most` filters. Their responses are
    /// compared at the frequencies `hz`.
    pub(crate) fn new(
        design: &mut Design,
        conditions: &[&[f64]],
        hz: RangeInclusive<f64>,
        most: usize,
    ) -> Self {
        let frequencies = design.frequencies_hz();
        let respond = |side: &&[f64]| {
            let all = design.response(side).into_iter().zip(&frequencies);
            all.filter(|(_, f)| hz.contains(f)).map(|(r, _)| r).collect()
        };
        let responses = weighted(conditions.iter().map(respond).collect());
        let columns = independent(&responses, most);
        // The product of the columns with their transpose is a large matrix, with one row for each
        // condition. The product in the other order is small and has the same eigenvalues. The
        // large matrix's eigenvectors follow from those of the small matrix.
        let (values, vectors) = eigen(products(&columns));
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
        let weights: Vec<Vec<f64>> = order
            .into_iter()
            // Rounding may make the smallest eigenvalues negative.
            .filter(|&k| values[k] > 0.0)
            .map(|k| {
                let scale = 1.0 / values[k].sqrt();
                let column = vectors.iter().map(|row| row[k] * scale);
                combined(&columns, &column.collect::<Vec<f64>>())
            })
            .collect();
        let filters = weights.iter().map(|w| combined(conditions, w)).collect();
        Self { weights, filters }
    }

    pub(crate) fn len(&self) -> usize {
        self.filters.len()
    }

    /// Returns the first `count` filters and their weights as integers.
    pub(crate) fn stored(&self, count: usize) -> StoredFilters {
        let (weights, filters) = (&self.weights[..count], &self.filters[..count]);
        // The small start avoids a division by zero if all numbers are zero.
        let largest = |all: &[f64]| all.iter().fold(1e-30, |most: f64, x| most.max(x.abs()));
        let integer = |x: f64, largest: f64| (x / largest * LARGEST).round() as i16;
        let scale =
            |(w, f): (&Vec<f64>, &Vec<f64>)| (largest(w) / LARGEST * (largest(f) / LARGEST)) as f32;
        let weights_of = |condition: usize| {
            let all = weights.iter();
            all.map(move |w| integer(w[condition], largest(w)))
        };
        let conditions = weights.first().map_or(0, Vec::len);
        let row = |f: &Vec<f64>| f.iter().map(|c| integer(*c, largest(f))).collect();
        StoredFilters {
            scales: weights.iter().zip(filters).map(scale).collect(),
            weights: (0..conditions).flat_map(weights_of).collect(),
            filters: filters.iter().map(row).collect(),
        }
    }
}

impl StoredFilters {
    /// Returns the filter of each condition.
    pub(crate) fn conditions(&self) -> Vec<Vec<f64>> {
        let mixed = |weights: &[i16]| {
            let mut sum = vec![0.0; self.filters.first().map_or(0, Vec::len)];
            for ((weight, scale), filter) in weights.iter().zip(&self.scales).zip(&self.filters) {
                let weight = f64::from(*weight) * f64::from(*scale);
                let pairs = sum.iter_mut().zip(filter);
                pairs.for_each(|(sum, c)| *sum += weight * f64::from(*c));
            }
            sum
        };
        self.weights.chunks(self.scales.len()).map(mixed).collect()
    }
}

/// Weights the responses at each frequency by the square root of a sum over all conditions: the sum
/// of their inverse powers at this frequency. The product of two weighted responses is then
/// relative to the power at this frequency.
fn weighted(mut responses: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let frequencies = responses.first().map_or(0, Vec::len);
    let mut inverse = vec![0.0; frequencies];
    for response in &responses {
        let most = response.iter().fold(0.0, |most: f64, r| most.max(r * r));
        let pairs = inverse.iter_mut().zip(response);
        // The second floor avoids a division by zero if the whole response is zero.
        pairs.for_each(|(sum, r)| *sum += 1.0 / (r * r).max(FLOOR * most).max(1e-30));
    }
    for response in &mut responses {
        let pairs = response.iter_mut().zip(&inverse);
        pairs.for_each(|(r, inverse)| *r *= inverse.sqrt());
    }
    responses
}

/// Computes the pivoted Cholesky factor of the matrix of the vectors' inner products. Returns its
/// columns, at most `most`.
fn independent(vectors: &[Vec<f64>], most: usize) -> Vec<Vec<f64>> {
    let mut left: Vec<f64> = vectors.iter().map(|v| dot(v, v)).collect();
    let all: f64 = left.iter().sum();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    while columns.len() < most.min(vectors.len()) {
        let pivot = (0..left.len()).max_by(|&a, &b| left[a].total_cmp(&left[b]));
        let Some(pivot) = pivot.filter(|&pivot| left[pivot] > NOTHING * all) else {
            break;
        };
        let root = left[pivot].sqrt();
        let at = |i: usize| {
            let known: f64 = columns.iter().map(|c| c[i] * c[pivot]).sum();
            (dot(&vectors[i], &vectors[pivot]) - known) / root
        };
        let column: Vec<f64> = (0..vectors.len()).map(at).collect();
        let pairs = left.iter_mut().zip(&column);
        pairs.for_each(|(left, c)| *left -= c * c);
        // Otherwise a rounding error could remain here, and the same pivot would be chosen again.
        left[pivot] = 0.0;
        columns.push(column);
    }
    columns
}

/// Returns the inner products of all pairs of vectors.
fn products(vectors: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let row = |a: &Vec<f64>| vectors.iter().map(|b| dot(a, b)).collect();
    vectors.iter().map(row).collect()
}

/// Returns the weighted sum of vectors.
fn combined<V: AsRef<[f64]>>(vectors: &[V], weights: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; vectors.first().map_or(0, |v| v.as_ref().len())];
    for (vector, weight) in vectors.iter().zip(weights) {
        let pairs = sum.iter_mut().zip(vector.as_ref());
        pairs.for_each(|(sum, x)| *sum += weight * x);
    }
    sum
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Returns the eigenvalues of a symmetrical matrix, and its eigenvectors as columns, by Jacobi's
/// rotations.
fn eigen(mut a: Vec<Vec<f64>>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = a.len();
    let unit = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect();
    let mut v: Vec<Vec<f64>> = (0..n).map(unit).collect();
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                let apq = a[p][q];
                // The limit is relative to the diagonal, so that small eigenvalues become as
                // accurate as large ones.
                if apq.abs() <= f64::EPSILON * (a[p][p] * a[q][q]).abs().sqrt() {
                    continue;
                }
                rotated = true;
                let theta = (a[q][q] - a[p][p]) / (2.0 * apq);
                // Two rotations set the element to zero. The sweeps converge with the smaller
                // rotation. `signum` is 1 at 0, so this also rotates equal diagonal elements.
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for row in a.iter_mut().chain(&mut v) {
                    let (x, y) = (row[p], row[q]);
                    (row[p], row[q]) = (c * x - s * y, s * x + c * y);
                }
                for j in 0..n {
                    let (x, y) = (a[p][j], a[q][j]);
                    (a[p][j], a[q][j]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
        if !rotated {
            break;
        }
    }
    ((0..n).map(|i| a[i][i]).collect(), v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_in_a_plane_need_two() {
        let mut design = Design::new(2000.0, 5.0);
        let [a, b] = [0.5f64, -0.4].map(|d| (0..=32).map(|i| d.powi(i)).collect::<Vec<f64>>());
        let mix = |x: f64| -> Vec<f64> { a.iter().zip(&b).map(|(a, b)| x * a + b).collect() };
        let conditions = [0.0, 0.3, 1.0, 2.0, 5.0].map(mix);
        let sides = conditions.each_ref().map(Vec::as_slice);
        let factors = Factors::new(&mut design, &sides, 0.0..=1000.0, 16);
        let stored = factors.stored(2);
        for (exact, got) in conditions.iter().zip(stored.conditions()) {
            let pairs = exact.iter().zip(&got);
            let error = pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
            assert!(error < 5e-4, "{error}");
        }
    }

    #[test]
    fn eigenvectors_are_those_of_the_matrix() {
        let matrix = vec![vec![4.0, 1.0, 0.5], vec![1.0, 3.0, -1.0], vec![0.5, -1.0, 2.0]];
        let (values, vectors) = eigen(matrix.clone());
        for k in 0..3 {
            let vector: Vec<f64> = vectors.iter().map(|row| row[k]).collect();
            for (row, x) in matrix.iter().zip(&vector) {
                assert!((dot(row, &vector) - values[k] * x).abs() < 1e-12);
            }
        }
    }
}
