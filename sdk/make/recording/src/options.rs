//! Options of reading recordings.

use htex_format::Quantity;

use crate::columns::map::ColumnMap;
use crate::error::ReadProblem;
use crate::recording::{MAX_RATE_HZ, check_rate};
use crate::tracker::Tracker;
use crate::value_limit::{MOST_VALUES, ValueLimit};

/// Options for reading a recording. An option supplies a fact that the file does not state.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Sample rate, hertz. Required if the file states no rate and has no times. A given rate takes
    /// precedence over the times and over the file's own rate. For a WAV or FLAC file, a given rate
    /// must equal the file's rate.
    pub rate_hz: Option<f64>,
    /// Roles of columns. A column that is not in the map gets its role from its name.
    pub map: Option<ColumnMap>,
    /// Quantity of the texture's signal.
    pub quantity: Quantity,
    /// The physical value of a full-scale sample (1.0), in the quantity's unit. This scale applies
    /// to WAV, FLAC and NPY files that are read without a column map. Without a scale, the reader
    /// assumes 1 and warns.
    pub scale: Option<f64>,
    /// Start of the part to read, in seconds after the file's first sample.
    pub from_s: Option<f64>,
    /// End of the part to read, in seconds after the file's first sample.
    pub to_s: Option<f64>,
    /// A second file, which contains the finger's motion.
    pub tracker: Option<Tracker>,
    /// Largest number of values that the reader keeps in memory from each file; `None` means
    /// [`MOST_VALUES`]. Values in unused columns do not count.
    pub most_values: Option<usize>,
}

impl ReadOptions {
    #[must_use]
    pub fn with_rate_hz(mut self, rate_hz: impl Into<Option<f64>>) -> Self {
        self.rate_hz = rate_hz.into();
        self
    }

    /// Sets the roles of columns.
    #[must_use]
    pub fn with_map(mut self, map: impl Into<Option<ColumnMap>>) -> Self {
        self.map = map.into();
        self
    }

    /// Sets the quantity of the texture's signal.
    #[must_use]
    pub fn with_quantity(mut self, quantity: Quantity) -> Self {
        self.quantity = quantity;
        self
    }

    /// Sets the physical value of a full-scale sample in a WAV, FLAC or NPY file.
    #[must_use]
    pub fn with_scale(mut self, scale: impl Into<Option<f64>>) -> Self {
        self.scale = scale.into();
        self
    }

    /// Sets the start of the part to read, in seconds after the file's first sample.
    #[must_use]
    pub fn with_from_s(mut self, from_s: impl Into<Option<f64>>) -> Self {
        self.from_s = from_s.into();
        self
    }

    /// Sets the end of the part to read, in seconds after the file's first sample.
    #[must_use]
    pub fn with_to_s(mut self, to_s: impl Into<Option<f64>>) -> Self {
        self.to_s = to_s.into();
        self
    }

    /// Sets the largest number of values that the reader keeps in memory from each file.
    #[must_use]
    pub fn with_most_values(mut self, most_values: impl Into<Option<usize>>) -> Self {
        self.most_values = most_values.into();
        self
    }

    /// Sets the second file, which contains the finger's motion.
    #[must_use]
    pub fn with_tracker(mut self, tracker: impl Into<Option<Tracker>>) -> Self {
        self.tracker = tracker.into();
        self
    }

    /// Returns the limit on the numbers kept in memory.
    pub(crate) fn value_limit(&self) -> ValueLimit {
        ValueLimit { most_values: self.most_values.unwrap_or(MOST_VALUES) }
    }

    /// Refuses option values with which no file can be read.
    pub(crate) fn check(&self) -> Result<(), ReadProblem> {
        let refuse = |option, problem| Err(ReadProblem::Option { option, problem });
        match (self.rate_hz, self.scale) {
            (Some(rate), _) if check_rate(rate).is_err() => refuse(
                "rate_hz",
                format!(
                    "the given sample rate is {rate}; it must be above 0 and at most {MAX_RATE_HZ} Hz"
                ),
            ),
            (_, Some(scale)) if !scale.is_finite() || scale == 0.0 => {
                refuse("scale", format!("the given scale is {scale}; it must be finite and not 0"))
            }
            _ => Ok(()),
        }
    }
}
