//! The error that settings are graded by: the vertical axis of figures, fronts and knees.

use std::fmt;

use htex_format::{ErrorMeasure, Measure};
use serde::{Serialize, Serializer};

/// An error of settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ErrorAxis {
    /// Fitted to the odd blocks of a recording, played, and compared with the even ones in third
    /// octaves: in units of the error of the odd blocks themselves, as a second recording has it.
    #[default]
    HeldOut,
    /// Compared with what the setting was fitted to, in decibels: by the model's magnitudes against
    /// bytes, by rendered samples against time.
    Fitted(ErrorMeasure),
}

impl ErrorAxis {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::HeldOut,
        Self::Fitted(ErrorMeasure::NineBand),
        Self::Fitted(ErrorMeasure::ThirdOctave),
        Self::Fitted(ErrorMeasure::LogSpectral),
    ];

    /// Returns the name in JSON: `held_out`.
    pub const fn id(self) -> &'static str {
        match self {
            Self::HeldOut => "held_out",
            Self::Fitted(measure) => measure.id(),
        }
    }

    /// Returns the error with a name in JSON.
    pub fn find(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|error| error.id() == id)
    }

    /// Returns the name in running text: `held-out error`.
    pub fn name(self) -> &'static str {
        match self {
            Self::HeldOut => "held-out error",
            Self::Fitted(measure) => measure.name(),
        }
    }

    /// Returns the unit of its values.
    pub(crate) const fn unit(self) -> &'static str {
        match self {
            Self::HeldOut => "of a second recording",
            Self::Fitted(_) => "dB",
        }
    }

    /// Returns a value with its unit: `1.20 dB`.
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

/// The measure of the held-out error.
pub(crate) const HELD_OUT_MEASURE: Measure = Measure::ThirdOctave;
