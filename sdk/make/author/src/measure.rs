//! Measures of agreement with a reference spectrum. This module computes each measure of
//! [`Measure`] for three kinds of data: a model's magnitudes, the spectrum of a recording of the
//! played texture, and rendered samples.

use htex_dsp::bands::{
    BAND_COUNT, BandBank, band_error_db, energy_matching_gain, pearson_correlation, rms,
};
use htex_dsp::fidelity::{log_spectral_distance_db, third_octave_error_rms_db};
use htex_dsp::grid::{GRID_HZ, level_rms};
use htex_format::{Measure, Measures, Quality};
use htex_host::{HostError, LoadedModel, Stream};

use crate::segments::choose_segments;
use crate::spectrum::{SpectrumRef, spectra_of_segments};
use crate::{AuthorError, Averaging, Recording, SegmentChoice, TextureSpectrum};

/// Length of the rendering that is measured, seconds. Its band energies scatter by about 0.2 dB.
const SECONDS: f64 = 20.0;
// The seed is always the same, so that measuring an asset again gives the same errors.
const SEED: u64 = 1;

/// Agreement of a spectrum with a reference. An agreement consists of the errors in nine bands and
/// of all measures that need only magnitudes (all except [`Measure::Felt`]). The paper's regression
/// uses the same nine bands, but with standardised absolute differences.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    pub measures: Measures,
    /// Energy of the spectrum relative to the energy of the reference, in each of the nine bands,
    /// decibels.
    pub band_error_db: Vec<f64>,
    /// The gain that would make the total energy of the spectrum equal to the total energy of the
    /// reference, decibels.
    pub matching_gain_db: f64,
}

impl Agreement {
    /// Returns the value of a measure; `None` if the measure cannot be computed for this reference.
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

/// Compares magnitudes with a reference. The magnitudes are at the reference's frequencies.
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

/// Measures how well parameters at a level agree with a recorded spectrum, in two ways: with the
/// magnitudes that would be measured in a recording of the played texture ([`read_spectrum`]), and
/// with rendered samples. Also returns these magnitudes.
///
/// # Errors
/// When the model refuses the parameters.
pub(crate) fn measure(
    model: &LoadedModel,
    parameters: &[f64],
    level_rms: f64,
    reference: SpectrumRef<'_>,
) -> Result<(Vec<f64>, Quality), AuthorError> {
    let rendered = rendered_spectrum(model, parameters, level_rms, reference)?;
    let by_samples = agreement(reference, &rendered).measures;
    // Lines interfere with each other. So the spectrum measured in a recording of the lines follows
    // from the lines' samples and not from their magnitudes.
    let read = if model.has_lines() {
        rendered
    } else {
        read_spectrum(model, parameters, level_rms, reference)?
    };
    let of_both = Measure::of_both().filter(|m| m.row().stored);
    let quality = Quality {
        by_samples: by_samples.only(of_both),
        ..Quality::from(agreement(reference, &read))
    };
    Ok((read, quality))
}

/// Returns the nine-band RMS difference between the shapes of the fitted and the stored parameters,
/// decibels.
pub(crate) fn rounding_error_db(
    model: &LoadedModel,
    fitted: &[f64],
    stored: &[f64],
    reference: SpectrumRef<'_>,
) -> Result<f64, AuthorError> {
    let bank = BandBank::new(BAND_COUNT, reference.band, reference.frequency_hz);
    let energies = |parameters: &[f64]| {
        let shape = model.magnitude(parameters, reference.band, reference.frequency_hz)?;
        Ok::<_, HostError>(bank.energies(&shape))
    };
    Ok(rms(&band_error_db(&energies(fitted)?, &energies(stored)?)))
}

/// Returns the magnitudes that a recording of the played texture would have, at the reference's
/// frequencies. For most models, this function computes these magnitudes without random numbers,
/// from the model's own magnitudes and the Hann window ([`LoadedModel::read_magnitude`]). This
/// computation includes only the main lobe of the window, which is not enough for a model with
/// spectral lines. For such a model, this function renders samples and measures their spectrum
/// (`rendered_spectrum`).
///
/// # Errors
/// Returns an error if the model refuses the parameters, or if it renders samples that are not
/// finite.
pub fn read_spectrum(
    model: &LoadedModel,
    parameters: &[f64],
    level_rms: f64,
    reference: SpectrumRef<'_>,
) -> Result<Vec<f64>, AuthorError> {
    if model.has_lines() {
        return rendered_spectrum(model, parameters, level_rms, reference);
    }
    let shape = model.read_magnitude(parameters, reference.band)?;
    Ok(shape.iter().map(|m| m * level_rms).collect())
}

/// Renders parameters at a level, and measures the spectrum of the samples in the same way as the
/// spectrum of a recording. The average is an RMS, because a model's magnitudes are RMS values.
///
/// # Errors
/// When the model cannot render, or renders samples that are not finite.
fn rendered_spectrum(
    model: &LoadedModel,
    parameters: &[f64],
    level_rms: f64,
    reference: SpectrumRef<'_>,
) -> Result<Vec<f64>, AuthorError> {
    // Four times the band's upper end: a whole number of samples per segment.
    let rate_hz = 4.0 * reference.band.last_bin() as f64 * GRID_HZ;
    let mut samples = vec![0.0f32; (SECONDS * rate_hz) as usize];
    Stream::new(model, parameters, reference.band, rate_hz, SEED)?.render(&mut samples)?;
    spectrum_of_samples(&samples, rate_hz, level_rms, reference)
}

/// Scales samples with an RMS of 1 to a level, and returns their magnitudes at the reference's
/// frequencies, in the level's unit. The spectra of the segments are averaged as an RMS. Magnitudes
/// above the samples' Nyquist frequency are 0.
///
/// # Errors
/// Returns an error if there are too few samples, or some samples are not finite.
pub fn spectrum_of_samples(
    samples: &[f32],
    rate_hz: f64,
    level_rms: f64,
    reference: SpectrumRef<'_>,
) -> Result<Vec<f64>, AuthorError> {
    let scaled = samples.iter().map(|&x| f64::from(x) * level_rms).collect();
    let recording = Recording::new("samples", rate_hz, vec![scaled])?;
    let segments = choose_segments(&recording, SegmentChoice::Windows);
    let part = spectra_of_segments(&recording, segments, None)?;
    let mut magnitude = TextureSpectrum::average(&[part], Averaging::Rms)?.magnitude;
    magnitude.resize(reference.frequency_hz.len(), 0.0);
    Ok(magnitude)
}
