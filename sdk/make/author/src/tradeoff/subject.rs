//! Prepares the subjects of a sweep: the recordings on which the sweep measures its contenders
//! (models with a setting, and baselines).

use crate::{AuthorError, SpectrumOptions, Take, TextureSpectrum, segment_take};
use htex_base::finding::Notice;

use crate::tradeoff::held_out::HeldOut;

/// A recording on which contenders are measured, with its spectrum and its variation.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Name of the file, or of the simulated surface.
    pub name: String,
    /// Whether the recording comes from a simulator.
    pub simulated: bool,
    /// The spectrum to which models are fitted.
    pub spectrum: TextureSpectrum,
    /// Warnings, as sentences.
    pub warnings: Vec<Notice>,
    /// Its odd and even blocks, or the reason why it has none.
    pub(crate) held_out: Result<HeldOut, &'static str>,
    /// The first lateral axis.
    pub(crate) samples: Vec<f32>,
    pub(crate) rate_hz: f64,
    pub(crate) bytes: usize,
    pub(crate) digest: blake3::Hash,
}

impl Subject {
    /// Computes the spectrum of a recording. If `strict` is true, a recording with findings that
    /// are errors or warnings is refused.
    ///
    /// # Errors
    /// Returns an error if the recording cannot be used.
    pub fn new(take: &Take, options: &SpectrumOptions, strict: bool) -> Result<Self, AuthorError> {
        let recording = &take.recording;
        let read = segment_take(take, options, strict)?;
        let (part, warnings) = (read.spectra, read.warnings);
        let held_out = HeldOut::new(&part, options);
        let spectrum = TextureSpectrum::average(&[part], options.averaging)?;
        let axes = &recording.axes;
        let samples = |axis: &Vec<f64>| axis.iter().map(|&x| x as f32).collect();
        Ok(Self {
            name: recording.source.clone(),
            simulated: recording.simulated,
            held_out,
            samples: axes.first().map(samples).unwrap_or_default(),
            rate_hz: recording.rate_hz,
            bytes: axes.iter().map(|axis| size_of::<f32>() * axis.len()).sum(),
            digest: digest(axes, recording.rate_hz, &spectrum),
            spectrum,
            warnings,
        })
    }

    /// Returns an error if no part of the recording can be held out.
    pub(crate) fn check_held_out(&self) -> Result<(), AuthorError> {
        match &self.held_out {
            Ok(_) => Ok(()),
            Err(reason) => {
                Err(AuthorError::NothingHeldOut { recording: self.name.clone(), reason })
            }
        }
    }
}

/// Returns a hash of everything on which results depend: the samples and their spectrum.
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
