//! Input and output of a setup, recorded together.

use htex_author::Recording;
use htex_author::recording::{ColumnMap, MapEntry, ReadError, ReadProblem, Role};

use std::fmt;

use serde::Serialize;

use crate::error::LabError;

/// Highest sample rate, hertz, and largest absolute value of a sample. The limits are the same as
/// for recordings.
const MOST_HZ: f64 = 1e9;
const LARGEST: f64 = 1e12;

/// One of the two signals of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// The force of the hammer, or the drive of the display.
    Input,
    /// The response of the rig or the display.
    Output,
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Input => "input",
            Self::Output => "output",
        })
    }
}

/// Input and output of a setup, recorded together.
///
/// Both channels have the same length. Their samples are finite, with absolute values of at most
/// 1e12, and neither channel is constant. Any units are allowed. The response is in the output's
/// unit per unit of the input.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    file: String,
    rate_hz: f64,
    start_s: f64,
    input: Vec<f64>,
    output: Vec<f64>,
}

impl Record {
    /// Creates a record from the channels of a file. The first samples are at 0 s.
    ///
    /// # Errors
    /// Returns an error if the sample rate is not above 0 or is above 1e9 Hz, the channels have
    /// different lengths, a sample is not finite or is beyond 1e12, or a channel is constant or
    /// empty.
    pub fn new(
        file: impl Into<String>,
        rate_hz: f64,
        input: Vec<f64>,
        output: Vec<f64>,
    ) -> Result<Self, LabError> {
        let record = Self { file: file.into(), rate_hz, start_s: 0.0, input, output };
        record.check()?;
        Ok(record)
    }

    /// Creates a record from a recording that was read with [`column_map`]. The recording's first
    /// axis is the input, and its second axis is the output.
    ///
    /// # Errors
    /// Returns the errors of [`Self::new`], and an error if the recording does not have two axes.
    pub fn from_recording(recording: Recording) -> Result<Self, LabError> {
        let start_s = recording.second(0);
        let signals = recording.axes.len();
        let file = recording.source;
        let mut axes = recording.axes.into_iter();
        match (axes.next(), axes.next(), axes.next()) {
            (Some(input), Some(output), None) => {
                let record = Self::new(file, recording.rate_hz, input, output)?;
                Ok(Self { start_s, ..record })
            }
            _ => Err(LabError::Signals { file, signals }),
        }
    }

    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Returns the number of samples of a channel.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.input.len()
    }

    /// Returns the time of a sample in its file, seconds.
    #[must_use]
    pub fn second(&self, sample: usize) -> f64 {
        self.start_s + sample as f64 / self.rate_hz
    }

    #[must_use]
    pub fn channel(&self, channel: Channel) -> &[f64] {
        match channel {
            Channel::Input => &self.input,
            Channel::Output => &self.output,
        }
    }

    fn check(&self) -> Result<(), LabError> {
        let (file, rate_hz) = (self.file.clone(), self.rate_hz);
        let (input, output) = (self.input.len(), self.output.len());
        if !(rate_hz > 0.0 && rate_hz <= MOST_HZ) {
            return Err(LabError::Rate { file, rate_hz });
        }
        if input != output {
            return Err(LabError::Lengths { file, input, output });
        }
        self.check_channel(Channel::Input)?;
        self.check_channel(Channel::Output)
    }

    fn check_channel(&self, channel: Channel) -> Result<(), LabError> {
        let (file, values) = (self.file.clone(), self.channel(channel));
        // NaN also fails this comparison.
        let is_sound = |value: &f64| value.abs() <= LARGEST;
        if let Some(sample) = values.iter().position(|value| !is_sound(value)) {
            return Err(LabError::Sample { file, channel, sample, value: values[sample] });
        }
        let value = values.first().copied().unwrap_or(0.0);
        if values.iter().all(|other| *other == value) {
            return Err(LabError::Constant { file, channel, value });
        }
        Ok(())
    }
}

/// Returns the column map for reading the input and the output of a recording. `input` and `output`
/// have the form `COLUMN` or `COLUMN:SCALE`, or are expressions. `others` maps further roles, for
/// example `time=stamp_ms:0.001`. Without a scale, values are used as they are in the file.
///
/// ```
/// let map = htex_lab::response::column_map("hammer_V:22.5", "fx1+fx2", None)?;
/// assert_eq!(map.entries().len(), 2);
/// # Ok::<(), htex_lab::LabError>(())
/// ```
///
/// # Errors
/// Returns an error if `input` or `output` is neither a column nor an expression, if both name the
/// same column, or if `others` maps an axis.
pub fn column_map(
    input: &str,
    output: &str,
    others: Option<&ColumnMap>,
) -> Result<ColumnMap, LabError> {
    let mut entries = vec![
        entry(Channel::Input, Role::LateralX, input)?,
        entry(Channel::Output, Role::LateralY, output)?,
    ];
    let others = others.map_or(&[][..], ColumnMap::entries);
    let is_other = |role| [Role::Time, Role::Normal, Role::Speed, Role::X, Role::Y].contains(&role);
    if let Some(axis) = others.iter().find(|entry| !is_other(entry.role)) {
        let problem = format!(
            "the map's {} is not used here: input and output are given by themselves, with their scales",
            axis.role
        );
        return Err(LabError::Columns { problem });
    }
    entries.extend(others.iter().cloned());
    ColumnMap::new(entries).map_err(|error| LabError::Columns { problem: problem_of(error) })
}

/// If no scale is given, uses a scale of 1, because the unit of a column does not matter here.
fn entry(channel: Channel, role: Role, text: &str) -> Result<MapEntry, LabError> {
    let mut entry = MapEntry::parse(role, text)
        .map_err(|error| LabError::Column { channel, problem: problem_of(error) })?;
    entry.scale = entry.scale.or(Some(1.0));
    Ok(entry)
}

/// Returns what is wrong with a map, without the general advice about maps.
fn problem_of(error: ReadError) -> String {
    match error.problem {
        ReadProblem::Map(problem) => problem,
        _ => error.to_string(),
    }
}
