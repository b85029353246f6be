//! Hann windows in the three common definitions, and their equivalent noise bandwidth.
//!
//! Each is `0.5 - 0.5 cos(2π x) = sin²(π x)`; they differ in the range of `x`. The periodic window is the
//! default for spectra: a sinusoid on the grid leaks into its two neighbouring bins only, at half its height.

use alloc::vec::Vec;
use core::f64::consts::PI;

/// Periodic Hann window of `n` samples: `w[i] = sin²(π i / n)` (SciPy's `sym=False`).
///
/// ```
/// let window = htex_dsp::window::hann_periodic(8);
/// assert_eq!(window[0], 0.0);
/// assert_eq!(window[4], 1.0);
/// ```
pub fn hann_periodic(n: usize) -> Vec<f64> {
    (0..n).map(|i| sine_squared(i, n)).collect()
}

/// Symmetric Hann window of `n` samples, zero at both ends: `w[i] = sin²(π i / (n - 1))`.
/// One sample gives `[1.0]`.
pub fn hann_symmetric(n: usize) -> Vec<f64> {
    if n == 1 {
        return alloc::vec![1.0];
    }
    (0..n).map(|i| sine_squared(i, n - 1)).collect()
}

/// Symmetric Hann window without its zero ends (MATLAB's `hanning`):
/// `w[i] = sin²(π (i + 1) / (n + 1))`.
pub fn hann_interior(n: usize) -> Vec<f64> {
    (0..n).map(|i| sine_squared(i + 1, n + 1)).collect()
}

/// Equivalent noise bandwidth in DFT bins, `n Σw² / (Σw)²` (Harris 1978, eq. 15): 1.5 for the
/// periodic Hann window, NaN for an empty or all-zero one.
pub fn equivalent_noise_bandwidth_bins(window: &[f64]) -> f64 {
    let sum: f64 = window.iter().sum();
    let sum_of_squares: f64 = window.iter().map(|w| w * w).sum();
    window.len() as f64 * sum_of_squares / (sum * sum)
}

/// `sin²(π i / period)`, computed by reflection at the middle, so that the window is exactly symmetric.
fn sine_squared(i: usize, period: usize) -> f64 {
    let i = i.min(period - i);
    let sine = crate::trig::sin(PI * i as f64 / period as f64);
    sine * sine
}
