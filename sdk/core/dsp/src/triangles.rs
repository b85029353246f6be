//! Banks of overlapping triangular filters over any axis, used by [`MelBank`](crate::mel::MelBank)
//! and [`BandBank`](crate::bands::BandBank).

use alloc::vec::Vec;

/// The nonzero part of one filter.
#[derive(Debug, Clone, PartialEq)]
struct Triangle {
    first: usize,
    weights: Vec<f64>,
}

/// A bank of triangular filters with apex 1: a sparse matrix of `rows()` filters by `columns()`
/// frequencies. Filter `i` extends from edge `i` to edge `i + 2` and has its apex at edge `i + 1`.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleBank {
    triangles: Vec<Triangle>,
    columns: usize,
}

impl TriangleBank {
    /// Makes a bank of `edges.len() - 2` filters at the positions `axis`. Edges and positions are
    /// ascending and have the same unit. The flanks are linear in this unit. A filter that lies
    /// between two neighbouring positions is empty.
    pub fn new(edges: &[f64], axis: &[f64]) -> Self {
        let triangles =
            edges.windows(3).map(|edge| Triangle::new([edge[0], edge[1], edge[2]], axis)).collect();
        Self { triangles, columns: axis.len() }
    }

    /// Number of filters.
    pub fn rows(&self) -> usize {
        self.triangles.len()
    }

    /// Number of frequencies.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Weight of filter `row` at frequency `column`; 0 outside the bank.
    pub fn weight(&self, row: usize, column: usize) -> f64 {
        self.triangles.get(row).map_or(0.0, |triangle| {
            column
                .checked_sub(triangle.first)
                .and_then(|i| triangle.weights.get(i))
                .copied()
                .unwrap_or(0.0)
        })
    }

    /// Sum of each filter's weights, 0 for an empty filter.
    pub fn row_sums(&self) -> Vec<f64> {
        self.triangles.iter().map(|triangle| triangle.weights.iter().sum()).collect()
    }

    /// Writes `out = bank · values`. `values` has `columns()` elements, `out` has `rows()`. Missing
    /// values count as zero, and surplus values are ignored.
    pub fn apply(&self, values: &[f64], out: &mut [f64]) {
        for (sum, triangle) in out.iter_mut().zip(&self.triangles) {
            let under = values.get(triangle.first..).unwrap_or(&[]);
            *sum = triangle.weights.iter().zip(under).map(|(w, v)| w * v).sum();
        }
    }

    /// The full matrix, row by row.
    pub fn to_dense(&self) -> Vec<f64> {
        let mut dense = alloc::vec![0.0; self.rows() * self.columns];
        for (row, triangle) in dense.chunks_mut(self.columns.max(1)).zip(&self.triangles) {
            row[triangle.first..triangle.first + triangle.weights.len()]
                .copy_from_slice(&triangle.weights);
        }
        dense
    }
}

impl Triangle {
    fn new([left, apex, right]: [f64; 3], axis: &[f64]) -> Self {
        // Positions on the edges have weight 0, so they are left out.
        let first = axis.partition_point(|&x| x <= left);
        let end = axis.partition_point(|&x| x < right).max(first);
        let weights =
            axis[first..end]
                .iter()
                .map(|&x| {
                    if x <= apex {
                        (x - left) / (apex - left)
                    } else {
                        (right - x) / (right - apex)
                    }
                })
                .collect();
        Self { first, weights }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sparse_and_dense_agree_with_empty_filters() {
        let bank = TriangleBank::new(&[0.0, 0.2, 0.4, 2.0, 3.0], &[0.0, 1.0, 2.0, 3.0]);
        assert_eq!(bank.row_sums()[0], 0.0);
        let dense = bank.to_dense();
        for row in 0..bank.rows() {
            for column in 0..bank.columns() {
                assert_eq!(bank.weight(row, column), dense[row * 4 + column]);
            }
        }
        let mut out = [0.0; 3];
        bank.apply(&[1.0; 4], &mut out);
        assert_eq!(out.to_vec(), bank.row_sums());
    }
}
