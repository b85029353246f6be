//! By which error two spectra are compared.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::Quality;

/// A measure of how far a representation lies from the recording, decibels.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum ErrorMeasure {
    /// RMS of the energy errors of nine overlapping bands.
    #[default]
    NineBand,
    /// RMS of the energy errors of third-octave bands.
    ThirdOctave,
    /// RMS over the bins of the decibels between the magnitudes.
    LogSpectral,
}

impl ErrorMeasure {
    /// All measures.
    pub const ALL: [Self; 3] = [Self::NineBand, Self::ThirdOctave, Self::LogSpectral];

    /// The error by this measure, from the model's magnitudes; none if it was not measured.
    pub fn of(self, quality: &Quality) -> Option<f64> {
        match self {
            Self::NineBand => Some(quality.band_error_rms_db),
            Self::ThirdOctave => quality.third_octave_error_rms_db,
            Self::LogSpectral => quality.log_spectral_distance_db,
        }
    }

    /// The name in running text: `nine-band error`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NineBand => "nine-band error",
            Self::ThirdOctave => "third-octave error",
            Self::LogSpectral => "log-spectral distance",
        }
    }
}

impl fmt::Display for ErrorMeasure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
