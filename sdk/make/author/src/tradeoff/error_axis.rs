//! The error by which settings are judged: the vertical axis of figures, fronts and knees.

use std::fmt;

use htex_format::{ErrorMeasure, Measure};
use serde::{Serialize, Serializer};

/// An error by which settings are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ErrorAxis {
    /// Held-out error: the model is fitted to the odd blocks of a recording and played. The result
    /// is compared with the even blocks in third octaves. The unit of this error is the difference
    /// between the odd and the even blocks of the recording. A model with an error of 1 is
    /// therefore as good as a second recording.
    #[default]
    HeldOut,
    /// Error relative to the spectrum to which the setting was fitted, in decibels. When settings
    /// are compared by error and size in bytes, the error is measured on the model's magnitudes.
    /// When settings are compared by error and time, the error is measured on rendered samples.
    Fitted(ErrorMeasure),
}

impl ErrorAxis {
    /// All errors.
    pub const ALL: [Self; 4] = [
        Self::HeldOut,
        Self::Fitted(ErrorMeasure::NineBand),
        Self::Fitted(ErrorMeasure::ThirdOctave),
        Self::Fitted(ErrorMeasure::LogSpectral),
    ];

    /// Returns the name in JSON, e.g. `held_out`.
    pub const fn id(self) -> &'static str {
        match self {
            Self::HeldOut => "held_out",
            Self::Fitted(measure) => measure.id(),
        }
    }

    /// Returns the error that has this name in JSON.
    pub fn find(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|error| error.id() == id)
    }

    /// Returns the name for use in a sentence, e.g. `held-out error`.
    pub fn name(self) -> &'static str {
        match self {
            Self::HeldOut => "held-out error",
            Self::Fitted(measure) => measure.name(),
        }
    }

    /// Returns the unit of the error's values.
    pub(crate) const fn unit(self) -> &'static str {
        match self {
            Self::HeldOut => "of a second recording",
            Self::Fitted(_) => "dB",
        }
    }

    /// Formats a value with its unit: `1.20 dB`.
    pub(crate) fn amount(self, value: f64) -> String {
        format!("{value:.2} {}", self.unit())
    }
}

impl fmt::Display for ErrorAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for ErrorAxis {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

/// The measure used for the held-out error.
pub(crate) const HELD_OUT_MEASURE: Measure = Measure::ThirdOctave;
