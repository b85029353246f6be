//! The orthonormal cosine transform, which turns log band energies into cepstral coefficients.
//!
//! This module computes it as plain sums, because an FFT is not faster for tens of bands.

use alloc::vec::Vec;
use core::f64::consts::PI;

/// Computes the first `out.len()` coefficients of the orthonormal DCT-II of `values`
/// (`scipy.fft.dct(values, type=2, norm="ortho")[:k]`). Coefficients beyond `values.len()` are 0.
pub fn dct_ii(values: &[f64], out: &mut [f64]) {
    let n = values.len();
    for (k, coefficient) in out.iter_mut().enumerate() {
        let sum: f64 = (0..n).map(|i| values[i] * cosine(k, i, n)).sum();
        *coefficient = if k < n { scale(k, n) * sum } else { 0.0 };
    }
}

/// The inverse of [`dct_ii`], with a precomputed table for a fixed number of values.
///
/// ```
/// use htex_dsp::dct::{InverseDct, dct_ii};
/// let mut coefficients = [0.0; 4];
/// dct_ii(&[1.0, 5.0, 2.0, 0.0], &mut coefficients);
/// let mut back = [0.0; 4];
/// InverseDct::new(4).run(&coefficients, &mut back);
/// assert!((back[1] - 5.0).abs() < 1e-14);
/// ```
#[derive(Debug, Clone)]
pub struct InverseDct {
    scale: Vec<f64>,
    /// A row of cosines for each value.
    cosines: Vec<f64>,
}

impl InverseDct {
    /// Makes the table for `values` output values.
    pub fn new(values: usize) -> Self {
        let row = |i: usize| (0..values).map(move |k| cosine(k, i, values));
        Self {
            scale: (0..values).map(|k| scale(k, values)).collect(),
            cosines: (0..values).flat_map(row).collect(),
        }
    }

    /// Computes the values from the first coefficients. Missing coefficients count as zero, and
    /// coefficients beyond the number of values are ignored. Elements of `out` beyond the number of
    /// values do not change. Does not allocate.
    pub fn run(&self, coefficients: &[f64], out: &mut [f64]) {
        let rows = self.cosines.chunks(self.scale.len().max(1));
        for (value, row) in out.iter_mut().zip(rows) {
            let terms = coefficients.iter().zip(&self.scale).zip(row);
            *value = terms.map(|((c, scale), cosine)| scale * c * cosine).sum();
        }
    }
}

fn scale(k: usize, n: usize) -> f64 {
    let numerator = if k == 0 { 1.0 } else { 2.0 };
    crate::root::sqrt(numerator / n as f64)
}

/// `cos(π k (2i + 1) / 2n)`; the argument is first reduced in integers.
fn cosine(k: usize, i: usize, n: usize) -> f64 {
    let turn = k.wrapping_mul(2 * i + 1) % (4 * n);
    crate::trig::cos(PI * turn as f64 / (2 * n) as f64)
}
