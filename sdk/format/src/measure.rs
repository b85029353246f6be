//! Measures of the error between two spectra.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::Quality;

/// A measure of the error of a representation, decibels.
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
    /// RMS over the bins of the difference of the magnitudes in decibels.
    LogSpectral,
}

impl ErrorMeasure {
    /// All measures.
    pub const ALL: [Self; 3] = [Self::NineBand, Self::ThirdOctave, Self::LogSpectral];

    /// Returns the error by this measure, from the model's magnitudes; `None` if it was not measured.
    pub fn of(self, quality: &Quality) -> Option<f64> {
        match self {
            Self::NineBand => Some(quality.band_error_rms_db),
            Self::ThirdOctave => quality.third_octave_error_rms_db,
            Self::LogSpectral => quality.log_spectral_distance_db,
        }
    }

    /// Returns the name in running text: `nine-band error`.
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
