//! The periodic Hann window, `0.5 - 0.5 cos(2π x) = sin²(π x)`: a sinusoid on the grid leaks into its two
//! neighbouring bins only, at half its height.

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

/// `sin²(π i / period)`, computed by reflection at the middle, so that the window is exactly symmetric.
fn sine_squared(i: usize, period: usize) -> f64 {
    let i = i.min(period - i);
    let sine = crate::trig::sin(PI * i as f64 / period as f64);
    sine * sine
}
