//! Recordings as the subjects of a sweep.

use htex_author::{AuthorError, SegmentSpectra, SpectrumOptions, Take, TextureSpectrum, read_take};
use htex_finding::Notice;

use crate::accuracy::{Accuracy, accuracy};

/// A recording with its spectrum and repeatability.
#[derive(Debug, Clone)]
pub struct Subject {
    /// File name, or name of a simulated surface.
    pub name: String,
    /// Whether it was computed instead of recorded.
    pub simulated: bool,
    /// The spectrum that models are fitted to.
    pub spectrum: TextureSpectrum,
    /// Warnings, as sentences.
    pub warnings: Vec<Notice>,
    /// Difference between odd and even strokes; `None` for a single stroke.
    pub(crate) repeats: Option<Accuracy>,
    /// The first lateral axis.
    pub(crate) samples: Vec<f32>,
    pub(crate) rate_hz: f64,
    pub(crate) bytes: usize,
    pub(crate) digest: blake3::Hash,
}

impl Subject {
    /// Reads the texture of a recording; with `strict`, findings that are errors or
    /// warnings are refused.
    ///
    /// # Errors
    /// When the recording is not usable.
    pub fn new(take: &Take, options: &SpectrumOptions, strict: bool) -> Result<Self, AuthorError> {
        let recording = &take.recording;
        let reading = read_take(take, options, strict)?;
        let (part, warnings) = (reading.part, reading.warnings);
        let repeats = repeats(&part, options)?;
        let spectrum = TextureSpectrum::average(&[part], options.averaging)?;
        let axes = &recording.axes;
        let samples = |axis: &Vec<f64>| axis.iter().map(|&x| x as f32).collect();
        Ok(Self {
            name: recording.source.clone(),
            simulated: recording.simulated,
            repeats,
            samples: axes.first().map(samples).unwrap_or_default(),
            rate_hz: recording.rate_hz,
            bytes: axes.iter().map(|axis| size_of::<f32>() * axis.len()).sum(),
            digest: digest(axes, recording.rate_hz, &spectrum),
            spectrum,
            warnings,
        })
    }
}

/// Compares the odd strokes with the even ones.
fn repeats(
    part: &SegmentSpectra,
    options: &SpectrumOptions,
) -> Result<Option<Accuracy>, AuthorError> {
    if part.spectra.len() < 2 {
        return Ok(None);
    }
    let half = |first: usize| {
        let spectra = part
            .spectra
            .iter()
            .skip(first)
            .step_by(2)
            .cloned()
            .collect();
        let part = SegmentSpectra {
            spectra,
            ..part.clone()
        };
        TextureSpectrum::average(&[part], options.averaging)
    };
    let (even, odd) = (half(0)?, half(1)?);
    let mut repeats = accuracy(&even, &odd.magnitude);
    // The error is the repeatability itself.
    repeats.felt.within_repeatability = true;
    Ok(Some(repeats))
}

/// Returns a hash of everything that results depend on: the samples and their spectrum.
fn digest(axes: &[Vec<f64>], rate_hz: f64, spectrum: &TextureSpectrum) -> blake3::Hash {
    let mut hasher = blake3::Hasher::new();
    let parts = axes.iter().chain([&spectrum.magnitude, &spectrum.signal]);
    for part in parts {
        hasher.update(&(part.len() as u64).to_le_bytes());
        part.iter().for_each(|x| {
            hasher.update(&x.to_le_bytes());
        });
    }
    hasher.update(&rate_hz.to_le_bytes());
    hasher.finalize()
}
