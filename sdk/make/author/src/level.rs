//! The level (RMS) stored with each representation.
//!
//! By default the level of a representation is the level of its recording. With `--level fitted`, a
//! representation has the level of the model's own fit. On simulated surfaces, this level differs
//! from the recording's level by up to 6 dB. The levels of sBeta and sSlope are too high, because
//! these models are fitted to the largest bins. sBeta is fitted mainly to the ten largest peaks,
//! and sSlope to the largest bin. In a noisy estimate of a spectrum, the largest bins are higher
//! than the true spectrum. The level of MFCC is too low because MFCC averages logarithms. For a
//! model such as Bands, the level follows from the energies that the model stores. The descriptor
//! of such a model states that the parameters contain the level
//! ([`htex_host::Descriptor::keeps_level`]), and the asset keeps the level of the model's fit.
//! sBeta and sSlope first round their parameters as the file does, and then compute the level from
//! the rounded parameters.
//!
//! A model with its own sample rate plays too weakly if its spectrum reaches up to half that rate.
//! The conversion to the player's rate removes up to half of the power at frequencies close to half
//! the model's rate. For AR, the loss is up to 3.0 dB at 1000 Hz, which is half of AR's sample
//! rate. The stored level compensates for this loss ([`LoadedModel::played_part`]), so that the
//! texture is played at the level of the recording.

use htex_dsp::grid::level_rms;
use htex_host::{Fit, HostError, LoadedModel};
use serde::{Deserialize, Serialize};

use crate::SpectrumRef;

/// Where a representation's level comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// The recording's RMS in the band, so that the asset plays at the level of its recording. If
    /// the played samples are recorded and fitted again, the level stays the same. Exception: for a
    /// model whose parameters contain the level ([`htex_host::Descriptor::keeps_level`]), the level
    /// of the model's fit is used.
    #[default]
    Recording,
    /// The level of the model's fit, adjusted to the rounded parameters that the file stores. The
    /// paper gives no rule for levels.
    Fitted,
}

impl Level {
    /// Both sources of the level, in the order of the command line's help.
    pub const ALL: &[Self] = &[Self::Fitted, Self::Recording];

    /// Returns the name used in recipes and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Recording => "recording",
            Self::Fitted => "fitted",
        }
    }
}

/// Returns the level to store for a fit: an RMS in the spectrum's unit. `stored` contains the fit's
/// parameters, rounded as the file stores them.
///
/// # Errors
/// Returns an error if the model refuses the parameters.
pub fn stored_level(
    model: &LoadedModel,
    fit: &Fit,
    stored: &[f64],
    spectrum: SpectrumRef<'_>,
    level: Level,
) -> Result<f64, HostError> {
    match level {
        Level::Recording if !model.descriptor().keeps_level => {
            let part = model.played_part(stored, spectrum.band)?;
            Ok(recorded_level(spectrum.magnitude) / part)
        }
        _ => fitted_level(model, fit, stored, spectrum),
    }
}

/// Returns the level at which the stored shape is closest to the fitted magnitudes, by least
/// squares over the band's grid.
fn fitted_level(
    model: &LoadedModel,
    fit: &Fit,
    stored: &[f64],
    spectrum: SpectrumRef<'_>,
) -> Result<f64, HostError> {
    if fit.parameters == stored {
        return Ok(fit.level_rms);
    }
    let shape = |parameters| model.magnitude(parameters, spectrum.band, spectrum.frequency_hz);
    let (fitted, stored) = (shape(&fit.parameters)?, shape(stored)?);
    let both: f64 = fitted.iter().zip(&stored).map(|(f, s)| f * s).sum();
    let own: f64 = stored.iter().map(|s| s * s).sum();
    Ok(fit.level_rms * (both / own))
}

/// Returns the RMS of magnitudes. Magnitudes are divided by the largest one first, to avoid
/// overflow and underflow.
pub(crate) fn recorded_level(magnitude: &[f64]) -> f64 {
    let largest = magnitude.iter().copied().fold(0.0, f64::max);
    if largest == 0.0 {
        return 0.0;
    }
    let relative: Vec<f64> = magnitude.iter().map(|m| m / largest).collect();
    largest * level_rms(&relative)
}
