//! Formats of recordings, and outcomes of takes.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::record::error::RecordError;
use crate::record::names;

/// File format of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Text with names, units and all digits. It can be read without further settings.
    #[default]
    Csv,
    /// A NumPy array (frames, signals) of f8.
    Npy,
    /// 32-bit floats. The value 1 means one newton, or one unit of the signal.
    Wav,
}

#[cfg(feature = "clap")]
impl clap::ValueEnum for Format {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::Csv, Self::Npy, Self::Wav]
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        Some(self.extension().into())
    }
}

/// Outcome of a take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// It kept to its target.
    Kept,
    /// It left its target; it was moved to the folder `rejected`.
    Rejected,
    /// It was cut short; it was moved to the folder `incomplete`.
    Incomplete,
}

impl Format {
    /// Refuses a sample rate that files of this format cannot have.
    ///
    /// # Errors
    /// [`RecordError::Setup`].
    pub(crate) fn check(self, rate_hz: f64) -> Result<(), RecordError> {
        let is_whole = rate_hz.fract() == 0.0 && rate_hz <= f64::from(u32::MAX);
        if self == Self::Wav && !is_whole {
            Err(RecordError::Setup {
                what: "the sample rate",
                value: rate_hz.to_string(),
                allowed: "a WAV has a whole number of hertz; record CSV or NPY",
            })
        } else {
            Ok(())
        }
    }

    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Npy => "npy",
            Self::Wav => "wav",
        }
    }
}

impl Outcome {
    /// Returns the subfolder for takes with this outcome; empty for the folder itself.
    pub(crate) fn folder(self) -> &'static Path {
        Path::new(match self {
            Self::Kept => "",
            Self::Rejected => names::REJECTED,
            Self::Incomplete => names::INCOMPLETE,
        })
    }
}
