//! Input and output of a setup, recorded together.

use htex_author::Recording;
use htex_author::recording::{ColumnMap, MapEntry, ReadError, ReadProblem, Role};

use super::error::{Channel, RecordProblem, ResponseError};

/// Highest sample rate, hertz, and largest magnitude of a sample; the same limits as for
/// recordings.
const MOST_HZ: f64 = 1e9;
const LARGEST: f64 = 1e12;

/// Input and output of a setup, recorded together.
///
/// Both channels have the same length and finite samples of at most 1e12, and neither is constant.
/// Any units are allowed; the response is in the output's unit per input's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    file: String,
    rate_hz: f64,
    start_s: f64,
    input: Vec<f64>,
    output: Vec<f64>,
}

impl Record {
    /// Creates a record from the channels of a file. They start at 0 s.
    ///
    /// # Errors
    /// The sample rate is not above 0 or is above 1e9 Hz, the channels have different lengths, a
    /// sample is not finite or is beyond 1e12, or a channel is constant or empty.
    pub fn new(
        file: impl Into<String>,
        rate_hz: f64,
        input: Vec<f64>,
        output: Vec<f64>,
    ) -> Result<Self, ResponseError> {
        let file = file.into();
        match check(rate_hz, &input, &output) {
            Err(problem) => Err(problem.of(file)),
            Ok(()) => Ok(Self { file, rate_hz, start_s: 0.0, input, output }),
        }
    }

    /// Creates a record from a recording that was read with [`column_map`]: its first axis is the
    /// input, its second the output.
    ///
    /// # Errors
    /// The errors of [`Self::new`], and an error if the recording does not have two axes.
    pub fn from_recording(recording: Recording) -> Result<Self, ResponseError> {
        let start_s = recording.second(0);
        let signals = recording.axes.len();
        let file = recording.source;
        let mut axes = recording.axes.into_iter();
        match (axes.next(), axes.next(), axes.next()) {
            (Some(input), Some(output), None) => {
                let record = Self::new(file, recording.rate_hz, input, output)?;
                Ok(Self { start_s, ..record })
            }
            _ => Err(RecordProblem::Signals { signals }.of(file)),
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
}

fn check(rate_hz: f64, input: &[f64], output: &[f64]) -> Result<(), RecordProblem> {
    if !(rate_hz > 0.0 && rate_hz <= MOST_HZ) {
        return Err(RecordProblem::Rate { rate_hz });
    }
    if input.len() != output.len() {
        let (input, output) = (input.len(), output.len());
        return Err(RecordProblem::Lengths { input, output });
    }
    check_channel(Channel::Input, input)?;
    check_channel(Channel::Output, output)
}

fn check_channel(channel: Channel, values: &[f64]) -> Result<(), RecordProblem> {
    // NaN does not pass this comparison either.
    let is_sound = |value: &f64| value.abs() <= LARGEST;
    if let Some(sample) = values.iter().position(|value| !is_sound(value)) {
        let value = values[sample];
        return Err(RecordProblem::Sample { channel, sample, value });
    }
    let value = values.first().copied().unwrap_or(0.0);
    if values.iter().all(|other| *other == value) {
        return Err(RecordProblem::Constant { channel, value });
    }
    Ok(())
}

/// Returns the map with which a recording's input and output are read. `input` and `output` are
/// `COLUMN`, `COLUMN:SCALE` or an expression. `others` maps further roles, for example
/// `time=stamp_ms:0.001`. Without a scale, values are used as they are in the file.
///
/// ```
/// let map = htex_lab::response::column_map("hammer_V:22.5", "fx1+fx2", None)?;
/// assert_eq!(map.entries().len(), 2);
/// # Ok::<(), htex_lab::response::ResponseError>(())
/// ```
///
/// # Errors
/// A text is not a column or expression, one column is given for both channels, or the further
/// roles include an axis.
pub fn column_map(
    input: &str,
    output: &str,
    others: Option<&ColumnMap>,
) -> Result<ColumnMap, ResponseError> {
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
        return Err(ResponseError::Columns { problem });
    }
    entries.extend(others.iter().cloned());
    ColumnMap::new(entries).map_err(|error| ResponseError::Columns { problem: problem_of(error) })
}

/// Uses a scale of 1 if none is given, because the unit of a column does not matter here.
fn entry(channel: Channel, role: Role, text: &str) -> Result<MapEntry, ResponseError> {
    let mut entry = MapEntry::parse(role, text)
        .map_err(|error| ResponseError::Column { channel, problem: problem_of(error) })?;
    entry.scale = entry.scale.or(Some(1.0));
    Ok(entry)
}

/// Returns what is wrong with a map, without advice about maps.
fn problem_of(error: ReadError) -> String {
    match error.problem {
        ReadProblem::Map(problem) => problem,
        _ => error.to_string(),
    }
}
