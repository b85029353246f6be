//! Measures the loss of an export. The module reads the written file back, computes the actuator's
//! vibration with the profile, and compares this vibration with the asset's own samples.

use htex_author::{
    AuthorError, Averaging, Difference, Recording, SegmentChoice, SpectrumOptions, TextureSpectrum,
    felt, segment_spectra, spectrum_of_samples,
};

use htex_dsp::grid::level_rms;
use htex_dsp::vibrotactile::Listener;
use serde::Serialize;

use crate::error::ExchangeError;
use crate::heard::{Heard, acceleration_of};
use crate::profile::{Kind, Profile};

/// How much an export loses.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Loss {
    /// Difference between the vibration that the actuator plays from the file and the asset's own
    /// samples. For the comparison, the actuator's acceleration is converted to the asset's unit so
    /// that equal values feel equally strong.
    #[serde(flatten)]
    pub difference: Difference,
    /// Level of the vibration that the actuator plays, relative to the asset's level, decibels.
    pub level_db: f64,
    /// Level of what the actuator plays, relative to the detection threshold of a sensitive finger,
    /// decibels. At 0 or less, nobody feels it. `None` if no actuator plays the file.
    #[serde(skip)]
    pub(crate) sensation_db: Option<f64>,
}

/// Compares what an actuator plays when driven by `drive` with what the asset plays (`heard`).
/// `drive` must have the sample rate of `heard`.
pub(crate) fn loss(heard: &Heard, drive: &[f64], profile: &Profile) -> Result<Loss, ExchangeError> {
    let samples = vec![heard.samples.clone()];
    let recording = Recording::from_axes(heard.quantity, "the asset", heard.rate_hz, samples)
        .map_err(AuthorError::from)?;
    let options = SpectrumOptions::default()
        .with_segments(SegmentChoice::Windows)
        .with_averaging(Averaging::Rms);
    let reference =
        TextureSpectrum::average(&[segment_spectra(&recording, &options)?], options.averaging)?;
    let mut samples: Vec<f32> = drive.iter().map(|x| *x as f32).collect();
    samples.resize(heard.samples.len(), 0.0);
    let driven = spectrum_of_samples(&samples, heard.rate_hz, 1.0, reference.as_ref())?;
    let in_unit = |(hertz, drive): (&f64, &f64)| {
        let strongest = match profile.kind {
            Kind::Resonant => profile.strongest_at(*hertz),
            // The drive is already the square of the level.
            Kind::Rotating => profile.strongest_m_s2.value,
        };
        drive * strongest / acceleration_of(heard.quantity, *hertz)
    };
    let magnitude = reference.frequency_hz.iter().zip(&driven).map(in_unit).collect();
    let other = TextureSpectrum { magnitude, ..reference.clone() };
    let listener = Listener::sensitive();
    let felt = felt(reference.as_ref(), &other.magnitude, heard.quantity, &listener);
    let energy = felt.level_db.iter().map(|db| libm::pow(10.0, db / 10.0));
    let level = |spectrum: &TextureSpectrum| level_rms(&spectrum.magnitude);
    let level_db = 20.0 * libm::log10(level(&other) / level(&reference));
    let difference = Difference::between(&reference, &other);
    Ok(Loss {
        difference: difference.ok_or(AuthorError::QuantitiesDiffer)?,
        level_db,
        sensation_db: Some(10.0 * libm::log10(energy.sum())),
    })
}
