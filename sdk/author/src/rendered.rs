//! The spectrum of rendered samples.

use htex_dsp::grid::GRID_HZ;
use htex_host::{LoadedModel, Stream};

use crate::spectrum::SpectrumRef;
use crate::{
    AuthorError, Averaging, Recording, SegmentChoice, SpectrumOptions, TextureSpectrum,
    segment_spectra,
};

/// Length of the rendering that is measured, seconds. Its band energies scatter by about 0.2 dB.
const SECONDS: f64 = 20.0;
// Always the same, so that measuring an asset again gives the same errors.
const SEED: u64 = 1;

/// Returns the magnitudes, on the reference's grid, that a recording of the voice would read. For
/// most models these are computed without chance: the model's magnitudes as a Hann window reads
/// them ([`LoadedModel::read_magnitude`]). For a model with lines, that covers only the window's
/// main lobe, so samples are rendered and measured instead ([`rendered_spectrum`]).
///
/// # Errors
/// When the model refuses the parameters, or renders samples that are not finite.
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

/// Renders parameters at a level and measures the samples like a recording. The average is an RMS,
/// because a model's magnitudes are RMS values.
///
/// # Errors
/// When the model cannot render, or renders samples that are not finite.
pub fn rendered_spectrum(
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

/// Returns the magnitudes of unit-RMS samples scaled to a level, in the level's unit, on the
/// reference's grid, RMS-averaged. Zero above the samples' Nyquist frequency.
///
/// # Errors
/// When there are too few samples, or they are not finite.
pub fn spectrum_of_samples(
    samples: &[f32],
    rate_hz: f64,
    level_rms: f64,
    reference: SpectrumRef<'_>,
) -> Result<Vec<f64>, AuthorError> {
    let scaled = samples.iter().map(|&x| f64::from(x) * level_rms).collect();
    let recording = Recording::new("samples", rate_hz, vec![scaled])?;
    let options = SpectrumOptions {
        segments: SegmentChoice::Windows,
        averaging: Averaging::Rms,
        response: None,
    };
    let part = segment_spectra(&recording, &options)?;
    let mut magnitude = TextureSpectrum::average(&[part], options.averaging)?.magnitude;
    magnitude.resize(reference.frequency_hz.len(), 0.0);
    Ok(magnitude)
}
