//! Errors of reading recordings, setup responses and motion traces.
//!
//! A reader reports what is wrong and where ([`Fault`]). The function that opens the file adds the
//! file's name to the error.

use std::borrow::Cow;
use std::{fmt, io};

use htex_base::finding::Hint;
use thiserror::Error;

use crate::recording::RecordingError;

/// An error of reading a recording, a setup response or a motion trace.
#[derive(Debug, Error)]
#[error("{file}{}: {problem}", .place.as_ref().map(|place| format!(", {place}")).unwrap_or_default())]
#[non_exhaustive]
pub struct ReadError {
    /// File name without its directory; `column map` if the error is in the column map.
    pub file: String,
    /// Place of the problem in the file; `None` if the problem is not at a single place.
    pub place: Option<Place>,
    /// What is wrong, and what the user can do about it.
    pub problem: ReadProblem,
}

/// What is wrong with a file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadProblem {
    #[error("cannot be read: {0}")]
    Io(io::Error),
    #[error("{bytes} bytes is more than the limit of {limit}; cut the recording into parts")]
    TooLarge { bytes: u64, limit: u64 },
    #[error(
        "it holds more than {limit} numbers, the limit of what is kept in memory; cut the recording into \
         parts, or raise the limit"
    )]
    TooManyValues { limit: usize },
    #[error("the file holds no data; expected a header row and at least 2 rows of numbers")]
    Empty,
    #[error("{rows} row(s) of numbers; a recording needs at least 2")]
    TooFewRows { rows: usize },
    /// A text file contains NUL bytes or invalid UTF-8.
    #[error(
        "{what}, which is not text; give a CSV saved as UTF-8, or a binary file of a known kind"
    )]
    NotText {
        /// The kind of byte.
        what: &'static str,
    },
    #[error("{bytes} bytes in one line, more than the limit of {limit}; expected one row per line")]
    LongLine { bytes: usize, limit: usize },
    #[error("{got} cells where the first row has {expected}; every row must have the same columns")]
    Ragged {
        /// Number of cells in the first row, and in this row.
        expected: usize,
        got: usize,
    },
    #[error(
        "the file seems truncated: its last line has {got} of {expected} cells; copy the file again or delete that line"
    )]
    CutOff { expected: usize, got: usize },
    #[error("{0}; every sample must be a finite number with a decimal point")]
    Cell(String),
    /// It is not clear which roles the columns have.
    #[error("{problem}; the columns are: {columns}")]
    Columns {
        /// What is missing or ambiguous, and what the user should give.
        problem: String,
        /// The names of the columns.
        columns: String,
    },
    #[error(
        "column {first:?} has {rows} numbers, {other:?} has {got}; map columns of equal lengths, such as the columns of one run"
    )]
    Lengths { first: String, rows: usize, other: String, got: usize },
    /// The file is damaged or of an unsupported kind, or its numbers are invalid.
    #[error("{0}")]
    Invalid(String),
    /// This build does not include the reader for the file's format.
    #[error(
        "this build does not read {formats}; build with the feature {feature}, use the Python package, \
         or convert the file to CSV"
    )]
    NotBuilt {
        /// The formats that the feature adds.
        formats: String,
        /// The feature that builds their readers.
        feature: &'static str,
    },
    #[error(
        "{0}; write ROLE=COLUMN[:SCALE] or ROLE=EXPRESSION, comma separated, as in \
         lateral=lateral_V:0.4444,normal=-#3*0.31"
    )]
    Map(String),
    #[error(
        "the time after {before} s is {after} s; it must increase on every row (a column with too few decimals repeats values); repair the column, or give the sample rate, which replaces it"
    )]
    Time {
        /// Times of the previous row and of this row, seconds.
        before: f64,
        after: f64,
    },
    #[error("it has no sample rate; give one")]
    NoRate,
    /// An option does not apply to this kind of file.
    #[error("{problem}")]
    Option {
        /// The option: a field of [`ReadOptions`](crate::ReadOptions), or `response`.
        option: &'static str,
        /// The option's value, and what to do instead.
        problem: String,
    },
    /// The signals are not a valid recording.
    #[error(transparent)]
    Recording(RecordingError),
}

/// A place in a file, for messages.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// A line of text, counted from 1.
    Line(usize),
    /// A row of numbers, counted from 1.
    Row(usize),
    /// A place of another kind, by its name: a byte, a channel, a data set or a cell.
    Named(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Row(row) => write!(f, "row {row}"),
            Self::Named(name) => f.write_str(name),
        }
    }
}

impl ReadError {
    pub fn hint(&self) -> Hint {
        Hint::new(match &self.problem {
            ReadProblem::TooManyValues { .. } => &["most_numbers"],
            ReadProblem::Time { .. } | ReadProblem::NoRate => &["rate"],
            ReadProblem::Columns { .. } => &["map", "quantity"],
            ReadProblem::Lengths { .. } => &["map"],
            ReadProblem::Option { option, .. } => match *option {
                "rate_hz" => &["rate"],
                "scale" => &["scale"],
                "map" => &["map"],
                "tracker" => &["tracker", "tracker_map"],
                _ => &[],
            },
            _ => &[],
        })
    }
}

impl ReadProblem {
    /// Adds the name of the file or source to a problem that concerns the whole file or source.
    #[must_use]
    pub fn in_file(self, file: &str) -> ReadError {
        Fault::from(self).in_file(file)
    }

    pub(crate) fn at_place(self, place: impl Into<Place>) -> Fault {
        Fault { place: Some(place.into()), problem: self }
    }

    pub(crate) fn invalid(problem: impl fmt::Display) -> Self {
        Self::Invalid(problem.to_string())
    }
}

/// Returns the fault for a cell that is not a finite number.
pub(crate) fn cell(row: Place, column: &str, problem: String) -> Fault {
    ReadProblem::Cell(problem).at_place(format!("{row}, column {column:?}"))
}

/// A problem, with its place in the file that is being read.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) place: Option<Place>,
    pub(crate) problem: ReadProblem,
}

impl Fault {
    pub(crate) fn in_file(self, file: &str) -> ReadError {
        ReadError { file: file.to_owned(), place: self.place, problem: self.problem }
    }
}

impl From<ReadProblem> for Fault {
    fn from(problem: ReadProblem) -> Self {
        Self { place: None, problem }
    }
}

impl From<io::Error> for ReadProblem {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        ReadProblem::Io(error).into()
    }
}

impl From<RecordingError> for Fault {
    fn from(error: RecordingError) -> Self {
        ReadProblem::Recording(error).into()
    }
}

impl From<String> for Place {
    fn from(name: String) -> Self {
        Self::Named(name)
    }
}

impl From<&str> for Place {
    fn from(name: &str) -> Self {
        Self::Named(name.to_owned())
    }
}

impl From<Cow<'_, str>> for Place {
    fn from(name: Cow<'_, str>) -> Self {
        Self::Named(name.into_owned())
    }
}
