//! Windowed-sinc kernels, computed once and shared.

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::shared::Shared;

/// Stop-band attenuation of the filters, decibels.
pub(crate) const ATTENUATION_DB: f64 = 70.0;

/// The length, the number of phases, whether the rows are exact, and the bits of the cut-off
/// frequency.
type Key = (usize, u64, bool, u64);

/// Returns the kernel of [`windowed_sinc`]. With `std`, all voices with the same rates share one
/// kernel.
pub(crate) fn kernel(taps: usize, phases: u64, exact: bool, cutoff: f64) -> Arc<[f32]> {
    static KERNELS: Shared<Key, [f32]> = Shared::new();
    let key = (taps, phases, exact, cutoff.to_bits());
    KERNELS.get(key, || windowed_sinc(taps, phases, exact, cutoff).into())
}

/// Computes a windowed sinc. The table has one row per phase, and one more row if rows are
/// interpolated. `cutoff` is in cycles per sample.
fn windowed_sinc(taps: usize, phases: u64, exact: bool, cutoff: f64) -> Vec<f32> {
    let rows = phases + u64::from(!exact);
    // Kaiser's formula for attenuations above 50 dB.
    let beta = 0.1102 * (ATTENUATION_DB - 8.7);
    let window = Kaiser::new(beta);
    let half = taps as f64 / 2.0;
    let mut all = Vec::with_capacity(rows as usize * taps);
    for row in 0..rows {
        let shift = row as f64 / phases as f64;
        let mut values: Vec<f64> = (0..taps)
            .map(|j| {
                // Input j of the window is at the time j - (taps/2 - 1), relative to the base.
                let t = j as f64 - (half - 1.0) - shift;
                sinc(2.0 * cutoff * t) * window.value_at(t / half)
            })
            .collect();
        // Every phase has unit gain at DC, so a constant input gives a constant output.
        let sum: f64 = values.iter().sum();
        values.iter_mut().for_each(|v| *v /= sum);
        all.extend(values.iter().map(|&v| v as f32));
    }
    all
}

/// Kaiser's estimate of the number of taps for a transition of `width` (cycles per sample).
pub(crate) fn kaiser_length(width: f64) -> usize {
    let n = (ATTENUATION_DB - 7.95) / (2.285 * core::f64::consts::TAU * width);
    libm::ceil(n).min(1e6) as usize + 1
}

fn sinc(x: f64) -> f64 {
    let a = core::f64::consts::PI * x;
    if x == 0.0 { 1.0 } else { crate::trig::sin(a) / a }
}

/// The Kaiser window.
struct Kaiser {
    beta: f64,
    scale: f64,
}

impl Kaiser {
    fn new(beta: f64) -> Self {
        let scale = 1.0 / bessel_i0(beta);
        Self { beta, scale }
    }

    /// The window at `x` in -1 to 1.
    fn value_at(&self, x: f64) -> f64 {
        if x.abs() > 1.0 {
            return 0.0;
        }
        self.scale * bessel_i0(self.beta * crate::root::sqrt(1.0 - x * x))
    }
}

fn bessel_i0(x: f64) -> f64 {
    let (mut sum, mut term, mut k) = (1.0, 1.0, 1.0);
    // All terms are positive, so nothing cancels. When the loop ends, the remaining terms are
    // smaller than the rounding error of the sum.
    while term > 1e-17 * sum {
        term *= (x / (2.0 * k)) * (x / (2.0 * k));
        sum += term;
        k += 1.0;
    }
    sum
}
