//! Measures of agreement between a spectrum and a reference.

use htex_dsp::bands::{
    BAND_COUNT, BandBank, band_error_db, energy_matching_gain, pearson_correlation, rms,
};
use htex_dsp::fidelity::{log_spectral_distance_db, third_octave_error_rms_db};

use crate::spectrum::SpectrumRef;

/// Agreement of a spectrum with a reference: the paper's spectral correlation; errors in the nine bands of its
/// regression, in decibels (the paper uses standardised absolute differences); and two measures that no model is fitted to.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Pearson correlation of the linear magnitudes.
    pub spectral_correlation: f64,
    /// Energy relative to the reference's in each of the nine bands, decibels.
    pub band_error_db: Vec<f64>,
    /// RMS of the nine band errors, decibels.
    pub band_error_rms_db: f64,
    /// The gain that equalises total energy, decibels.
    pub matching_gain_db: f64,
    /// RMS of the nine band errors after that gain, decibels.
    pub band_error_matched_rms_db: f64,
    /// RMS error over third-octave bands, decibels; `None` if the reference has no energy in any of them.
    pub third_octave_error_rms_db: Option<f64>,
    /// RMS over the bins of the difference of the magnitudes in decibels; `None` for a silent reference.
    pub log_spectral_distance_db: Option<f64>,
}

/// Compares magnitudes on the reference's grid with the reference.
pub fn agreement(reference: SpectrumRef<'_>, magnitude: &[f64]) -> Agreement {
    let bank = BandBank::new(BAND_COUNT, reference.band, reference.frequency_hz);
    let expected = bank.energies(reference.magnitude);
    let gain = energy_matching_gain(reference.magnitude, magnitude);
    let matched: Vec<f64> = magnitude.iter().map(|m| m * gain).collect();
    let error_db = band_error_db(&expected, &bank.energies(magnitude));
    Agreement {
        spectral_correlation: pearson_correlation(reference.magnitude, magnitude),
        band_error_rms_db: rms(&error_db),
        band_error_db: error_db,
        matching_gain_db: 20.0 * libm::log10(gain),
        band_error_matched_rms_db: rms(&band_error_db(&expected, &bank.energies(&matched))),
        third_octave_error_rms_db: third_octave_error_rms_db(
            reference.frequency_hz,
            reference.magnitude,
            magnitude,
        ),
        log_spectral_distance_db: log_spectral_distance_db(reference.magnitude, magnitude),
    }
}
