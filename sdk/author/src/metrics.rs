//! Measures of agreement between a spectrum and a reference: the function behind each row of
//! [`Measure`].

use htex_dsp::bands::{
    BAND_COUNT, BandBank, band_error_db, energy_matching_gain, pearson_correlation, rms,
};
use htex_dsp::fidelity::{log_spectral_distance_db, third_octave_error_rms_db};
use htex_dsp::grid::level_rms;
use htex_format::{Measure, Measures, Quality};

use crate::spectrum::SpectrumRef;

/// Agreement of a spectrum with a reference: every measure that needs only magnitudes (all but
/// [`Measure::Felt`]), and the errors in the nine bands of the paper's regression (which uses
/// standardised absolute differences).
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    pub measures: Measures,
    /// Energy in each of the nine bands relative to the reference, decibels.
    pub band_error_db: Vec<f64>,
    /// The gain at which the total energies are equal, decibels.
    pub matching_gain_db: f64,
}

impl Agreement {
    /// Returns a measure; `None` where the reference does not allow it.
    pub fn get(&self, measure: Measure) -> Option<f64> {
        self.measures.get(measure)
    }
}

impl From<Agreement> for Quality {
    /// Quality from magnitudes only, without rendered samples.
    fn from(agreement: Agreement) -> Self {
        Self {
            by_magnitude: agreement.measures.only(Measure::stored()),
            band_error_db: agreement.band_error_db,
            ..Self::default()
        }
    }
}

/// Compares magnitudes on the reference's grid with the reference.
pub fn agreement(reference: SpectrumRef<'_>, magnitude: &[f64]) -> Agreement {
    let bank = BandBank::new(BAND_COUNT, reference.band, reference.frequency_hz);
    let expected = bank.energies(reference.magnitude);
    let gain = energy_matching_gain(reference.magnitude, magnitude);
    let errors_db = |magnitude: &[f64]| band_error_db(&expected, &bank.energies(magnitude));
    let band_error_db = errors_db(magnitude);
    let measures = Measures::new(|measure| match measure {
        Measure::SpectralCorrelation => Some(pearson_correlation(reference.magnitude, magnitude)),
        Measure::NineBand => Some(rms(&band_error_db)),
        Measure::NineBandMatched => {
            let matched: Vec<f64> = magnitude.iter().map(|m| m * gain).collect();
            Some(rms(&errors_db(&matched)))
        }
        Measure::ThirdOctave => {
            third_octave_error_rms_db(reference.frequency_hz, reference.magnitude, magnitude)
        }
        Measure::LogSpectral => log_spectral_distance_db(reference.magnitude, magnitude),
        Measure::Level => {
            let ratio = level_rms(magnitude) / level_rms(reference.magnitude);
            Some(20.0 * libm::log10(ratio))
        }
        Measure::Felt => None,
    });
    Agreement { measures, band_error_db, matching_gain_db: 20.0 * libm::log10(gain) }
}
