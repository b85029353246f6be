//! Distance of a model's magnitude spectrum from a reference: the error in third-octave bands, and
//! the log-spectral distance bin by bin. No model of this project is fitted to either measure.
//!
//! Both functions expect slices of equal length. If one slice is longer than the other, its excess
//! values are ignored. Both functions raise the model's magnitudes to at least 1e-9 of the
//! reference's largest magnitude, so that the error of an empty band is large but finite.
//!
//! The nine-band error ([`crate::bands`]) favours the model `bands` with nine bands, because this
//! model stores exactly the energies from which the nine-band error is computed.

use alloc::vec::Vec;

use crate::bands::rms;

/// Number of third-octave bands: their edges are `20 · 2^(k/3)` Hz, with k from 0 to this number.
pub const THIRD_OCTAVES: usize = 17;
const LOWEST_HZ: f64 = 20.0;
/// Relative tolerance: a frequency that is lower than an edge by at most this part counts as on the
/// edge. Edges at 40, 80, ... Hz are bins of the grid, and rounding may make a computed edge
/// slightly too high.
const ON_EDGE: f64 = 1e-12;
/// Smallest magnitude of a model, relative to the largest of the reference.
const RELATIVE_FLOOR: f64 = 1e-9;

/// Third-octave error: RMS over the bands of `10 log10(model energy / reference energy)`, decibels.
/// The energy is the sum of squared magnitudes. Differences in level also contribute to the error,
/// because the function does not adjust the gain of the model first. A band counts only if it
/// contains a bin and the reference has energy in it. Returns `None` if there is no such band.
///
/// ```
/// use htex_dsp::fidelity::third_octave_error_rms_db;
/// let f = [20.0, 25.0, 30.0, 35.0, 40.0];
/// let error_db = third_octave_error_rms_db(&f, &[1.0; 5], &[2.0; 5]);
/// assert!((error_db.unwrap() - 20.0 * 2f64.log10()).abs() < 1e-12);
/// ```
pub fn third_octave_error_rms_db(
    frequency_hz: &[f64],
    reference: &[f64],
    model: &[f64],
) -> Option<f64> {
    let least = floor(reference);
    let mut energies = [(0.0, 0.0); THIRD_OCTAVES];
    for ((&f, &reference), &model) in frequency_hz.iter().zip(reference).zip(model) {
        if let Some(band) = third_octave(f) {
            let model = model.max(least);
            energies[band].0 += reference * reference;
            energies[band].1 += model * model;
        }
    }
    let heard = energies.iter().filter(|(reference, _)| *reference > 0.0);
    let errors_db: Vec<f64> =
        heard.map(|(reference, model)| 10.0 * libm::log10(model / reference)).collect();
    (!errors_db.is_empty()).then(|| rms(&errors_db))
}

/// Log-spectral distance: RMS of `20 log10(model / reference)`, decibels, over the bins in which
/// the reference is above 0. Returns `None` if there is no such bin.
pub fn log_spectral_distance_db(reference: &[f64], model: &[f64]) -> Option<f64> {
    let least = floor(reference);
    let heard = reference.iter().zip(model).filter(|(r, _)| **r > 0.0);
    let errors_db: Vec<f64> =
        heard.map(|(reference, model)| 20.0 * libm::log10(model.max(least) / reference)).collect();
    (!errors_db.is_empty()).then(|| rms(&errors_db))
}

fn floor(reference: &[f64]) -> f64 {
    RELATIVE_FLOOR * reference.iter().copied().fold(0.0, f64::max)
}

/// Returns the index of the third-octave band that contains a frequency. A band contains its lower
/// edge, but not its upper edge.
pub fn third_octave(frequency_hz: f64) -> Option<usize> {
    let edge_hz = |k: usize| LOWEST_HZ * libm::exp2(k as f64 / 3.0) * (1.0 - ON_EDGE);
    (0..THIRD_OCTAVES).find(|&k| edge_hz(k) <= frequency_hz && frequency_hz < edge_hz(k + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_that_are_bins_open_a_band() {
        let bands = [20.0, 25.0, 30.0, 40.0, 80.0, 640.0, 1000.0].map(third_octave);
        assert_eq!(
            bands,
            [0, 0, 1, 3, 6, 15, 16].map(Some),
            "25.2, 31.7 and 806 Hz are edges as well"
        );
        assert_eq!([19.9, 1016.0].map(third_octave), [None; 2]);
    }

    #[test]
    fn silence_gives_a_finite_error_and_an_empty_reference_none() {
        let f = [100.0, 105.0];
        assert_eq!(third_octave_error_rms_db(&f, &[1.0; 2], &[0.0; 2]), Some(180.0));
        assert_eq!(log_spectral_distance_db(&[1.0, 0.0], &[0.0, 5.0]), Some(180.0));
        assert_eq!(third_octave_error_rms_db(&f, &[0.0; 2], &[1.0; 2]), None);
        assert_eq!(log_spectral_distance_db(&[0.0; 2], &[1.0; 2]), None);
        assert_eq!(third_octave_error_rms_db(&[2000.0], &[1.0], &[1.0]), None);
    }
}
