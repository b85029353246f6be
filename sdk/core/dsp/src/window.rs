//! The periodic Hann window, `0.5 - 0.5 cos(2π x) = sin²(π x)`. A sinusoid on the grid leaks only
//! into its two neighbouring bins, at half its height.

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

/// Height of the window's transform at a distance of `bins` from a sinusoid: `sin(πd) / (πd (1 -
/// d²))`, which is 1 at the centre. The function covers only the main lobe: the result is 0 beyond
/// two bins on either side.
///
/// ```
/// use htex_dsp::window::hann_main_lobe;
/// assert_eq!([0.0, 1.0, -1.0, 2.0].map(hann_main_lobe), [1.0, 0.5, 0.5, 0.0]);
/// assert!((hann_main_lobe(0.5) - 0.8488).abs() < 1e-4);
/// ```
pub fn hann_main_lobe(bins: f64) -> f64 {
    let d = bins.abs();
    if d >= 2.0 {
        return 0.0;
    }
    if d < 1e-6 {
        return 1.0;
    }
    if (d - 1.0).abs() < 1e-6 {
        return 0.5;
    }
    let a = PI * d;
    crate::trig::sin(a) / (a * (1.0 - d * d))
}

/// `sin²(π i / period)`. The second half is a reflection of the first, so that the window is
/// exactly symmetric.
fn sine_squared(i: usize, period: usize) -> f64 {
    let i = i.min(period - i);
    let sine = crate::trig::sin(PI * i as f64 / period as f64);
    sine * sine
}
