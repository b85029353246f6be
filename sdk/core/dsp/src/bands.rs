//! Compares two texture spectra: by their energies in overlapping log-spaced bands, and by their
//! correlation.
//!
//! The project measures a model's fidelity in nine bands over 20 to 1000 Hz. An *energy* is the sum
//! of weight times squared magnitude, in the squared unit of the magnitudes.

use alloc::vec::Vec;

use crate::beta::log_unit;
use crate::grid::Band;
use crate::triangles::TriangleBank;

/// Number of bands by which the project compares spectra.
pub const BAND_COUNT: usize = 9;

/// Frequency that is added to all frequencies on the axis of [`edge_to_edge`], hertz. Below this
/// frequency, places on the axis are nearly proportional to the frequency; above it, nearly to its
/// logarithm. For example, 30 knots over 20 to 1000 Hz are 4.9 Hz apart at 20 Hz, and the bins are
/// 5 Hz apart. We tried values from 0 to 60 Hz for the knots of the model Bands: values around 20 Hz
/// gave the smallest third-octave error.
const CORNER_HZ: f64 = 20.0;

/// Position of a frequency on the band's axis `ln(f + 20 Hz)`: 0 at the lower edge, 1 at the upper
/// edge.
///
/// ```
/// use htex_dsp::{Band, bands::edge_to_edge};
/// let middle_hz = (40.0f64 * 1020.0).sqrt() - 20.0;
/// assert!((edge_to_edge(middle_hz, Band::TACTILE) - 0.5).abs() < 1e-12);
/// ```
pub fn edge_to_edge(frequency_hz: f64, band: Band) -> f64 {
    let raised = Band { low_hz: band.low_hz + CORNER_HZ, high_hz: band.high_hz + CORNER_HZ };
    log_unit(frequency_hz + CORNER_HZ, raised)
}

/// Floor that is added to both energies before they are divided, as a fraction of the largest
/// reference energy. It keeps the error of an empty band large but finite.
const RELATIVE_FLOOR: f64 = 1e-12;

/// A bank of triangular, log-spaced, half-overlapping bands. Their flanks are linear in the
/// logarithm of the frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct BandBank {
    edges_hz: Vec<f64>,
    bank: TriangleBank,
}

impl BandBank {
    /// Makes `count` bands over `band`, with weights at `frequencies_hz` (ascending, positive).
    ///
    /// ```
    /// use htex_dsp::{Band, bands::{BAND_COUNT, BandBank}};
    /// let band = Band::TACTILE;
    /// let bank = BandBank::new(BAND_COUNT, band, &band.grid_hz());
    /// assert_eq!(bank.energies(&[0.01; 197]).len(), 9);
    /// ```
    pub fn new(count: usize, band: Band, frequencies_hz: &[f64]) -> Self {
        let last = count + 1;
        // On this axis the edges are whole numbers, so they have no rounding error.
        let edges: Vec<f64> = (0..=last).map(|i| i as f64).collect();
        let axis: Vec<f64> =
            frequencies_hz.iter().map(|&f| log_unit(f, band) * last as f64).collect();
        let ratio = band.high_hz / band.low_hz;
        let edges_hz =
            (0..=last).map(|i| band.low_hz * libm::pow(ratio, i as f64 / last as f64)).collect();
        Self { edges_hz, bank: TriangleBank::new(&edges, &axis) }
    }

    /// The `count + 2` edges, hertz. Band `i` extends from edge `i` to edge `i + 2` and has its
    /// apex at edge `i + 1`.
    pub fn edges_hz(&self) -> &[f64] {
        &self.edges_hz
    }

    /// The weights, one filter per band.
    pub fn filters(&self) -> &TriangleBank {
        &self.bank
    }

    /// Energy of a magnitude spectrum in each band: `Σ weight · magnitude²`.
    pub fn energies(&self, magnitude: &[f64]) -> Vec<f64> {
        let power: Vec<f64> = magnitude.iter().map(|m| m * m).collect();
        let mut energies = alloc::vec![0.0; self.bank.rows()];
        self.bank.apply(&power, &mut energies);
        energies
    }
}

/// Error of each band in dB, from band *energies*: `10 log10((model + tiny) / (reference + tiny))`,
/// where `tiny` is 1e-12 of the largest reference band. If all energies of the model and the
/// reference are zero, the errors are 0 dB. If all energies of the reference are zero, but some
/// energies of the model are not, the errors are +∞ in the bands in which the model has energy.
pub fn band_error_db(reference: &[f64], model: &[f64]) -> Vec<f64> {
    let tiny = RELATIVE_FLOOR * reference.iter().copied().fold(0.0, f64::max);
    reference
        .iter()
        .zip(model)
        .map(|(&reference, &model)| ratio_db(model + tiny, reference + tiny))
        .collect()
}

fn ratio_db(model: f64, reference: f64) -> f64 {
    // Equal energies include two zeros, whose ratio would be NaN.
    if model == reference { 0.0 } else { 10.0 * libm::log10(model / reference) }
}

/// Returns the gain that gives a model's *magnitudes* the total energy of the reference: `sqrt(Σ
/// reference² / Σ model²)`. The gain is 1 if either sum is zero or not finite.
///
/// To compare spectral shapes independently of level, multiply the model's band energies by the
/// square of this gain.
pub fn energy_matching_gain(reference_magnitude: &[f64], model_magnitude: &[f64]) -> f64 {
    let total = |magnitude: &[f64]| magnitude.iter().map(|m| m * m).sum::<f64>();
    let gain = crate::root::sqrt(total(reference_magnitude) / total(model_magnitude));
    if gain.is_finite() && gain > 0.0 { gain } else { 1.0 }
}

/// Root mean square; 0 for an empty slice.
pub fn rms(values: &[f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    crate::root::sqrt(values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64)
}

/// Returns the Pearson correlation of two slices, a number from -1 to 1. If one slice is longer
/// than the other, its excess values are ignored.
///
/// The result is never NaN for finite input. If either slice is constant, the correlation is
/// undefined. The result is then 1 if the slices are equal, and 0 otherwise.
///
/// ```
/// use htex_dsp::bands::pearson_correlation;
/// assert!((pearson_correlation(&[1.0, 2.0, 4.0], &[3.0, 5.0, 9.0]) - 1.0).abs() < 1e-15);
/// assert_eq!(pearson_correlation(&[1.0, 2.0, 4.0], &[3.0, 3.0, 3.0]), 0.0);
/// ```
pub fn pearson_correlation(a: &[f64], b: &[f64]) -> f64 {
    let len = a.len().min(b.len());
    let (a, b) = (&a[..len], &b[..len]);
    if a == b {
        return 1.0;
    }
    let (a, b) = (deviations(a), deviations(b));
    // Each side is scaled by its largest deviation, so that the squares neither underflow nor
    // overflow.
    let product: f64 = a.iter().zip(&b).map(|(x, y)| x * y).sum();
    let norm = |values: &[f64]| crate::root::sqrt(values.iter().map(|v| v * v).sum());
    let correlation = product / (norm(&a) * norm(&b));
    if correlation.is_nan() { 0.0 } else { correlation.clamp(-1.0, 1.0) }
}

/// Deviations from the mean, divided by the largest deviation; all zero if the values are constant.
fn deviations(values: &[f64]) -> Vec<f64> {
    // The values are compared with each other and not with the mean, because rounding can move the
    // mean of equal values away from them.
    let varies = values.windows(2).any(|pair| pair[0] != pair[1]);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let largest = values.iter().map(|v| (v - mean).abs()).fold(0.0, f64::max);
    let scale = if varies { largest } else { f64::INFINITY };
    values.iter().map(|v| (v - mean) / scale).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degenerate_comparisons_are_defined() {
        assert_eq!(pearson_correlation(&[0.1; 7], &[0.1; 7]), 1.0);
        // Ten times 0.1 is not exactly 1, so the mean equals none of the values.
        assert_eq!(pearson_correlation(&[0.1; 10], &[0.3; 10]), 0.0);
        assert_eq!(pearson_correlation(&[], &[1.0]), 1.0);
        assert!((pearson_correlation(&[1e-200, 2e-200], &[2e200, 1e200]) + 1.0).abs() < 1e-12);
        assert_eq!(energy_matching_gain(&[1.0], &[0.0]), 1.0);
        assert_eq!(energy_matching_gain(&[4.0], &[2.0]), 2.0);
        assert_eq!(band_error_db(&[0.0], &[0.0]), [0.0]);
        assert!((band_error_db(&[1.0, 0.0], &[1.0, 0.0])[1]).abs() < 1e-12);
        assert_eq!(rms(&[]), 0.0);
    }
}
