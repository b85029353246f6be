//! Accuracy of a spectrum: six measures against a recording's.

use htex_author::{FeltError, TextureSpectrum, agreement};
use htex_dsp::grid::level_rms;
use serde::{Deserialize, Serialize};

/// Errors of a spectrum, compared with a recording's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Accuracy {
    pub(crate) spectral_correlation: f64,
    pub(crate) band_error_rms_db: f64,
    pub(crate) third_octave_error_rms_db: f64,
    pub(crate) log_spectral_distance_db: f64,
    /// RMS in the band relative to the recording's, decibels.
    pub(crate) level_error_db: f64,
    /// What is felt of the difference.
    pub(crate) felt: FeltError,
}

/// Error in decibels used for silence, and when there is nothing to compare with, so that all errors
/// are finite.
const FAR_DB: f64 = 200.0;

pub(crate) fn accuracy(reference: &TextureSpectrum, magnitude: &[f64]) -> Accuracy {
    let found = agreement(reference.as_ref(), magnitude);
    let ratio = level_rms(magnitude) / level_rms(&reference.magnitude);
    Accuracy {
        spectral_correlation: found.spectral_correlation,
        band_error_rms_db: found.band_error_rms_db,
        third_octave_error_rms_db: found.third_octave_error_rms_db.unwrap_or(FAR_DB),
        log_spectral_distance_db: found.log_spectral_distance_db.unwrap_or(FAR_DB),
        level_error_db: (20.0 * libm::log10(ratio)).clamp(-FAR_DB, FAR_DB),
        felt: FeltError::new(reference, magnitude, found.band_error_rms_db),
    }
}
