//! The error of all experiments.

use std::path::{Path, PathBuf};

use htex_base::finding::Hint;

use crate::response::Channel;

/// The error of an experiment. Recordings and answers that were made before the error remain on
/// disk.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LabError {
    /// A file could not be read or written, or its contents cannot be used. The file is a
    /// calibration matrix, a part file, the JSON next to a recording, a recording of felt forces,
    /// or an asset.
    #[error(transparent)]
    File(#[from] htex_base::files::FileError),
    /// Another program is writing to this file.
    #[error("{}: another htex is {doing}; wait for it to end", .file.display())]
    Busy {
        file: PathBuf,
        /// `recording into it` or `running this participant`.
        doing: &'static str,
    },
    /// A page cannot be served.
    #[error("cannot serve the page at 127.0.0.1:{port}: {problem}")]
    Page {
        /// The port; 0 if any free port was requested.
        port: u16,
        problem: String,
    },
    /// A folder, or a file in it, cannot be served as a page.
    #[error("{}: {problem}", .path.display())]
    Folder { path: PathBuf, problem: String },

    /// The source of the recorded signals, or a tracker, failed.
    #[error(transparent)]
    Source(#[from] htex_device::DeviceError),
    /// The column map does not match the channels of the source, or a recording cannot be read.
    #[error(transparent)]
    Read(#[from] htex_author::recording::ReadError),
    /// The source ended before the take was complete.
    #[error("the source ended {after_s:.3} s into a take of {seconds} s{}", with_place(.kept))]
    Ended {
        after_s: f64,
        /// Length of the take, seconds.
        seconds: f64,
        /// The file that contains what was recorded, if anything was.
        kept: Option<PathBuf>,
    },
    /// The source stopped with an error during a take.
    #[error("{error}{}", with_place(.kept))]
    Interrupted {
        error: Box<LabError>,
        /// The file that contains what was recorded, if anything was.
        kept: Option<PathBuf>,
    },
    /// The source delivers no samples.
    #[error("the source has delivered nothing for {seconds} s; check its cable and its clock")]
    Silent { seconds: u64 },
    /// The user ended the session.
    #[error("the session was ended{}", with_place(.kept))]
    Left {
        /// The file that contains what was recorded, if anything was.
        kept: Option<PathBuf>,
    },
    /// In every take, the motion left its target.
    #[error("none of {attempts} takes kept to the target; the last: {reasons}. They are in {}", .folder.display())]
    OffTarget {
        attempts: u32,
        /// What the last attempt did wrong.
        reasons: String,
        /// The folder of rejected takes.
        folder: PathBuf,
    },
    /// A value is not finite.
    #[error(
        "{role} is {value} at {at_s:.4} s; check the map for a division by zero, and the sensor"
    )]
    NotFinite {
        role: String,
        value: f64,
        /// Time since the source was started, seconds.
        at_s: f64,
    },
    /// There is a target for the speed or the force, but no signal measures this quantity.
    #[error("a target {what} is given, but the {what} is not measured; {advice}")]
    NotMeasured {
        /// `speed` or `force`.
        what: &'static str,
        advice: &'static str,
    },
    /// A value of the setup is out of range.
    #[error("{what} is {value}; {allowed}")]
    Setup { what: &'static str, value: String, allowed: &'static str },
    /// A line that a tracker sent does not consist of two numbers.
    #[error("tracker {name}, line {line}: {text:?} is not `x_mm y_mm` or `x_mm,y_mm`")]
    TrackerLine {
        name: String,
        /// Number of the line, from 1.
        line: usize,
        text: String,
    },

    /// The study has no such participant.
    #[error("the study has no participant {name:?}; it has {known}")]
    NoParticipant { name: String, known: String },
    /// A line in a file of answers is invalid.
    #[error("{}, line {line}: {problem}; restore the file from a copy, or give another folder", .file.display())]
    Line {
        /// The file of answers.
        file: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        problem: String,
    },
    /// The file of answers belongs to another version of the study, and a file must not mix the
    /// results of two versions.
    #[error(
        "{}: the answers there were begun with another version: {changed}. Restore what was there (the earlier settings, in the case of a \
         device), or start anew in another folder (-o)",
        .file.display()
    )]
    OtherVersion {
        /// The file of answers.
        file: PathBuf,
        changed: String,
    },
    /// A folder has no answers.
    #[error("{}: there are no answers (*.jsonl); name the folder that `htex study run -o` wrote to", .folder.display())]
    NoAnswers { folder: PathBuf },
    /// An asset has no measured error for a model, so a simulated participant cannot rate the
    /// model.
    #[error(
        "{texture}: the asset has no measured nine-band error for {model}, by which simulated participants rate; fit it again with `htex fit`"
    )]
    NoBandError { texture: String, model: String },
    /// The device ran out of samples in every attempt of a trial.
    #[error(
        "the device ran dry in {times} attempts of the same trial; the last: {error}. Close other programs or give the device a larger \
         buffer (in another folder, -o, since settings are not mixed); the trial is repeated when the same command is run again"
    )]
    RanDry {
        /// Number of attempts.
        times: u32,
        /// The last error.
        error: String,
    },
    /// The forces that the participant felt in a trial could not be recorded.
    #[error(
        "recording what is felt: {0}; the trial is repeated when the same command is run again"
    )]
    Felt(Box<LabError>),
    /// There are no recordings of felt forces.
    #[error("{}: the felt force was not recorded; give `htex study run` a source (--source)", .folder.display())]
    NotRecorded {
        /// The folder of answers.
        folder: PathBuf,
    },
    /// The requested attribute is not in the answers.
    #[error("the answers have the attributes {known}; name one of them")]
    Attribute { known: String },

    /// The text that names a channel's column cannot be parsed.
    #[error(
        "the {channel}: {problem}; write COLUMN, COLUMN:SCALE or an expression, as in hammer_V:22.5"
    )]
    Column { channel: Channel, problem: String },
    /// The input and the output name the same column, or the map of further columns contains an
    /// axis (x, y or z) of a texture's signal. A response has no such axes.
    #[error("input and output: {problem}")]
    Columns { problem: String },
    /// No recording was given.
    #[error("no recording is given; give at least one with input and output")]
    NoRecord,
    /// A recording does not have exactly one signal for each channel.
    #[error(
        "{file}: {signals} signals were read and 2 are needed; name one column as the input and one as the output"
    )]
    Signals {
        file: String,
        /// Number of signals that were read.
        signals: usize,
    },
    /// The channels of a recording have different numbers of samples.
    #[error(
        "{file}: the input has {input} samples and the output {output}; both must be recorded together, sample by sample"
    )]
    Lengths {
        file: String,
        /// Samples of the input.
        input: usize,
        /// Samples of the output.
        output: usize,
    },
    /// A sample rate is zero, negative, not finite or too high.
    #[error("{file}: the sample rate is {rate_hz} Hz; it must be above 0 and at most 1e9 Hz")]
    Rate { file: String, rate_hz: f64 },
    /// A sample is not finite, or beyond 1e12.
    #[error(
        "{file}: the {channel} is {value} at sample {sample} (counted from 0); cut the recording there, or correct its unit"
    )]
    Sample {
        file: String,
        channel: Channel,
        /// Index from 0.
        sample: usize,
        value: f64,
    },
    /// A channel does not change.
    #[error(
        "{file}: the {channel} is {value} at every sample; check that this is its column and that the sensor was on"
    )]
    Constant { file: String, channel: Channel, value: f64 },
    /// No part of the input is strong enough to count as a hit.
    #[error(
        "{file}: no hit found: the largest input is {largest:.4} and its noise {noise:.4} (RMS), and a hit must be 8 times above the noise; check that this is the hammer's column, or measure a continuous drive"
    )]
    NoHits {
        file: String,
        /// Largest difference of the input from its median.
        largest: f64,
        /// Noise of the input.
        noise: f64,
    },
    /// Recordings have different sample rates.
    #[error(
        "{file} was recorded at {rate_hz} Hz and {first} at {first_hz} Hz; measure recordings of one rate together"
    )]
    Rates {
        first: String,
        /// Sample rate of the first recording, hertz.
        first_hz: f64,
        /// The recording whose sample rate differs.
        file: String,
        rate_hz: f64,
    },
    /// A recording is shorter than one window.
    #[error(
        "{file} lasts {duration_s:.3} s, less than one window of {window_s} s; record longer or choose a shorter window"
    )]
    Short {
        file: String,
        duration_s: f64,
        /// Length of the window, seconds.
        window_s: f64,
    },
    /// A setting has a value that cannot be used.
    #[error("{option} is {value}; {problem}")]
    Option {
        option: &'static str,
        /// The setting behind the option.
        hint: Hint,
        value: f64,
        problem: String,
    },
    /// Fewer than two hits or windows can be averaged.
    #[error(
        "{used} of {found} {what} can be used, and coherence needs at least 2; {}", thrown_out(.reasons)
    )]
    TooFew {
        /// `hits` or `windows`.
        what: &'static str,
        found: usize,
        /// Number that can be used.
        used: usize,
        /// The place of each hit or window that was thrown out, and the reason.
        reasons: Vec<String>,
    },
    /// A magnitude of the response is outside the range that a response file may contain.
    #[error(
        "the magnitude {magnitude} at {frequency_hz} Hz is beyond 1e-9 to 1e9, which responses are limited to; scale the input or the output to another unit"
    )]
    Magnitude {
        frequency_hz: f64,
        /// The magnitude, in the output's unit per unit of the input.
        magnitude: f64,
    },
}

impl LabError {
    /// Returns whether the cause of the error is an invalid value of a setting or an argument.
    pub fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::Attribute { .. }
                | Self::NoParticipant { .. }
                | Self::Option { .. }
                | Self::Column { .. }
                | Self::Setup { .. }
                | Self::NotMeasured { .. }
        )
    }

    /// Returns the settings that a user can change to avoid the error.
    pub fn hint(&self) -> Hint {
        Hint::new(match self {
            Self::Columns { .. } | Self::Constant { .. } => &["input", "output"],
            Self::NoHits { .. } => &["input", "continuous"],
            Self::Short { .. } => &["window"],
            Self::Option { hint, .. } => return *hint,
            _ => &[],
        })
    }

    pub(crate) fn busy(file: &Path, doing: &'static str) -> Self {
        Self::Busy { file: file.to_owned(), doing }
    }

    /// Converts an error of a recording of felt forces to [`LabError::Felt`].
    pub fn felt(error: impl Into<Self>) -> Self {
        Self::Felt(Box::new(error.into()))
    }
}

fn with_place(file: &Option<PathBuf>) -> String {
    match file {
        Some(file) => format!("; what was recorded is in {}", file.display()),
        None => String::new(),
    }
}

/// Largest number of reasons in a message.
const MOST_REASONS: usize = 10;

fn thrown_out(reasons: &[String]) -> String {
    if reasons.is_empty() {
        return "record more".to_owned();
    }
    let shown = &reasons[..reasons.len().min(MOST_REASONS)];
    let more = match reasons.len() - shown.len() {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    format!("thrown out: {}{more}", shown.join("; "))
}
