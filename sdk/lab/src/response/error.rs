//! Errors of measuring a response.

use std::fmt;

use htex_base::finding::Hint;
use serde::Serialize;
use thiserror::Error;

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

/// Errors of measuring a response.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ResponseError {
    /// The text that names a channel's column cannot be parsed.
    #[error(
        "the {channel}: {problem}; write COLUMN, COLUMN:SCALE or an expression, as in hammer_V:22.5"
    )]
    Column { channel: Channel, problem: String },
    /// The columns of the channels cannot be read, or cannot be read together.
    #[error("input and output: {problem}")]
    Columns { problem: String },
    /// A recording cannot be used.
    #[error("{file}: {problem}")]
    Record { file: String, problem: RecordProblem },
    /// No recording was given.
    #[error("no recording is given; give at least one with input and output")]
    Nothing,
    /// Recordings have different sample rates.
    #[error(
        "{file} was recorded at {rate_hz} Hz and {first} at {first_hz} Hz; measure recordings of one rate together"
    )]
    Rates {
        first: String,
        /// Its rate, hertz.
        first_hz: f64,
        /// The recording that differs.
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
    /// An option has an impossible value.
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
        /// The hits or windows that were thrown out, each with place and reason.
        reasons: Vec<String>,
    },
    /// The response cannot be written in a form that `htex` reads.
    #[error(
        "the magnitude {magnitude} at {frequency_hz} Hz is beyond 1e-9 to 1e9, which responses are limited to; scale the input or the output to another unit"
    )]
    Magnitude {
        frequency_hz: f64,
        /// The magnitude, output over input.
        magnitude: f64,
    },
}

/// What is wrong with a recording.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordProblem {
    /// It does not hold exactly one signal for each channel.
    #[error(
        "{signals} signals were read and 2 are needed; name one column as the input and one as the output"
    )]
    Signals {
        /// Number of signals that were read.
        signals: usize,
    },
    /// The channels have different numbers of samples.
    #[error(
        "the input has {input} samples and the output {output}; both must be recorded together, sample by sample"
    )]
    Lengths {
        /// Samples of the input.
        input: usize,
        /// Samples of the output.
        output: usize,
    },
    /// The sample rate is zero, negative, not finite or too high.
    #[error("the sample rate is {rate_hz} Hz; it must be above 0 and at most 1e9 Hz")]
    Rate { rate_hz: f64 },
    /// A sample is not finite, or beyond 1e12.
    #[error(
        "the {channel} is {value} at sample {sample} (counted from 0); cut the recording there, or correct its unit"
    )]
    Sample {
        channel: Channel,
        /// Index from 0.
        sample: usize,
        value: f64,
    },
    /// A channel does not change.
    #[error(
        "the {channel} is {value} at every sample; check that this is its column and that the sensor was on"
    )]
    Constant { channel: Channel, value: f64 },
    /// No hit stands out from the input.
    #[error(
        "no hit found: the largest input is {largest:.4} and its noise {noise:.4} (RMS), and a hit must be 8 times above the noise; check that this is the hammer's column, or measure a continuous drive"
    )]
    NoHits {
        /// Largest distance of the input from its median.
        largest: f64,
        /// Noise of the input.
        noise: f64,
    },
}

impl RecordProblem {
    pub(crate) fn of(self, file: impl Into<String>) -> ResponseError {
        ResponseError::Record { file: file.into(), problem: self }
    }

    fn hint(&self) -> Hint {
        match self {
            Self::Constant { .. } => Hint::new(&["input", "output"]),
            Self::NoHits { .. } => Hint::new(&["input", "continuous"]),
            _ => Hint::NONE,
        }
    }
}

impl ResponseError {
    pub fn hint(&self) -> Hint {
        Hint::new(match self {
            Self::Columns { .. } => &["input", "output"],
            Self::Short { .. } => &["window"],
            Self::Option { hint, .. } => return *hint,
            Self::Record { problem, .. } => return problem.hint(),
            _ => &[],
        })
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
