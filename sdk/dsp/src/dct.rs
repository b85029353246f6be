//! The orthonormal cosine transform that turns log band energies into cepstral coefficients.
//!
//! Sums are written out: at tens of bands an FFT gains nothing.

use core::f64::consts::PI;

/// The first `out.len()` coefficients of the orthonormal DCT-II of `values`
/// (`scipy.fft.dct(values, type=2, norm="ortho")[:k]`). Coefficients beyond `values.len()` are 0.
pub fn dct_ii(values: &[f64], out: &mut [f64]) {
    let n = values.len();
    for (k, coefficient) in out.iter_mut().enumerate() {
        let sum: f64 = (0..n).map(|i| values[i] * cosine(k, i, n)).sum();
        *coefficient = if k < n { scale(k, n) * sum } else { 0.0 };
    }
}

/// Inverse of [`dct_ii`]: `out.len()` values from the first coefficients, the missing ones taken
/// as zero; coefficients beyond `out.len()` are ignored.
///
/// ```
/// use htex_dsp::dct::{dct_ii, inverse_dct_ii};
/// let mut coefficients = [0.0; 4];
/// dct_ii(&[1.0, 5.0, 2.0, 0.0], &mut coefficients);
/// let mut back = [0.0; 4];
/// inverse_dct_ii(&coefficients, &mut back);
/// assert!((back[1] - 5.0).abs() < 1e-14);
/// ```
pub fn inverse_dct_ii(coefficients: &[f64], out: &mut [f64]) {
    let n = out.len();
    for (i, value) in out.iter_mut().enumerate() {
        *value = coefficients
            .iter()
            .take(n)
            .enumerate()
            .map(|(k, c)| scale(k, n) * c * cosine(k, i, n))
            .sum();
    }
}

fn scale(k: usize, n: usize) -> f64 {
    let numerator = if k == 0 { 1.0 } else { 2.0 };
    crate::root::sqrt(numerator / n as f64)
}

/// `cos(π k (2i + 1) / 2n)`, its argument reduced in whole numbers first.
fn cosine(k: usize, i: usize, n: usize) -> f64 {
    let turn = k.wrapping_mul(2 * i + 1) % (4 * n);
    libm::cos(PI * turn as f64 / (2 * n) as f64)
}
