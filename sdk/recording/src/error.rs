//! Errors of reading recordings, setup responses and motion traces.

use std::io;

use thiserror::Error;

use crate::recording::RecordingError;
use crate::sheet::Place;

/// Errors of reading a recording, a setup response or a motion trace.
///
/// Lines are counted from 1, as in an editor. `file` is the name without its directory.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {source}")]
    Io {
        /// File name.
        file: String,
        /// The system's error.
        source: io::Error,
    },
    /// The file is larger than the limit.
    #[error(
        "{file}: {bytes} bytes is more than the limit of {limit}; cut the recording into parts"
    )]
    TooLarge {
        /// File name.
        file: String,
        /// The file's size.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// The file holds more numbers than the limit.
    #[error(
        "{file}: it holds more than {limit} numbers, the limit of what is kept in memory; cut the recording into \
         parts, or raise the limit"
    )]
    TooManyValues {
        /// File name.
        file: String,
        /// The limit.
        limit: usize,
    },
    /// The file has no rows.
    #[error("{file}: the file holds no data; expected a header row and at least 2 rows of numbers")]
    Empty {
        /// File name.
        file: String,
    },
    /// The file has a header but fewer than two rows.
    #[error("{file}: {rows} row(s) of numbers; a recording needs at least 2")]
    TooFewRows {
        /// File name.
        file: String,
        /// Rows found.
        rows: usize,
    },
    /// NUL bytes or invalid UTF-8.
    #[error(
        "{file}, line {line}: {what}, which is not text; give a CSV saved as UTF-8, or a binary file of a known kind"
    )]
    NotText {
        /// File name.
        file: String,
        /// Line of the first such byte.
        line: usize,
        /// The kind of byte.
        what: &'static str,
    },
    /// A line is longer than the limit.
    #[error(
        "{file}, line {line}: {bytes} bytes in one line, more than the limit of {limit}; expected one row per line"
    )]
    LongLine {
        /// File name.
        file: String,
        /// The line.
        line: usize,
        /// Its length in bytes.
        bytes: usize,
        /// The limit.
        limit: usize,
    },
    /// A row has another number of cells than the first.
    #[error(
        "{file}, line {line}: {got} cells where the first row has {expected}; every row must have the same columns"
    )]
    Ragged {
        /// File name.
        file: String,
        /// The line.
        line: usize,
        /// Cells in the first row.
        expected: usize,
        /// Cells in this row.
        got: usize,
    },
    /// The last line is shorter than the others.
    #[error(
        "{file}, line {line}: the file seems truncated: its last line has {got} of {expected} cells; copy the file again or delete that line"
    )]
    CutOff {
        /// File name.
        file: String,
        /// The line.
        line: usize,
        /// Cells in the first row.
        expected: usize,
        /// Cells in the last row.
        got: usize,
    },
    /// A cell is not a finite number.
    #[error(
        "{file}, {place}, column {column:?}: {problem}; every sample must be a finite number with a decimal point"
    )]
    Cell {
        /// File name.
        file: String,
        /// The line or row.
        place: Place,
        /// The column's name, or `#` and its number.
        column: String,
        /// What is wrong with the cell.
        problem: String,
    },
    /// The columns' roles are not clear.
    #[error("{file}: {problem}; the columns are: {columns}")]
    Columns {
        /// File name.
        file: String,
        /// What is missing or ambiguous, and what to give.
        problem: String,
        /// The names of the columns.
        columns: String,
    },
    /// Columns that are used together have different lengths.
    #[error(
        "{file}: column {first:?} has {rows} numbers, {other:?} has {got}; map columns of equal lengths, such as those of one run"
    )]
    Lengths {
        /// File name.
        file: String,
        /// A column.
        first: String,
        /// Its numbers.
        rows: usize,
        /// Another column.
        other: String,
        /// Its numbers.
        got: usize,
    },
    /// A file is damaged or of an unsupported kind.
    #[error("{file}, {place}: {problem}")]
    Damaged {
        /// File name.
        file: String,
        /// A byte, a channel, a data set.
        place: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// The file is of a kind whose reader was not built.
    #[error(
        "{file}: this build does not read Parquet, Arrow and HDF5 (MATLAB 7.3); build with the feature lab-files, use the Python package, \
         or convert the file to CSV"
    )]
    NotBuilt {
        /// File name.
        file: String,
    },
    /// A column map is malformed.
    #[error(
        "column map: {problem}; write ROLE=COLUMN[:SCALE] or ROLE=EXPRESSION, comma separated, as in \
         lateral=lateral_V:0.4444,normal=-#3*0.31"
    )]
    Map {
        /// What is wrong.
        problem: String,
    },
    /// A time column does not increase.
    #[error(
        "{file}, {place}: the time after {before} s is {after} s; it must increase on every row (a column with too few decimals repeats values); repair the column, or give the sample rate, which replaces it"
    )]
    Time {
        /// File name.
        file: String,
        /// The line or row of the later time.
        place: Place,
        /// Time of the previous row, seconds.
        before: f64,
        /// Time of this row, seconds.
        after: f64,
    },
    /// The sample rate is not known.
    #[error("{file}: it has no sample rate; give one")]
    NoRate {
        /// File name.
        file: String,
    },
    /// An option does not apply to this kind of file.
    #[error("{file}: {problem}")]
    Option {
        /// File name.
        file: String,
        /// The option: a field of [`ReadOptions`](crate::ReadOptions), or `response`.
        option: &'static str,
        /// Its value, and what to do instead.
        problem: String,
    },
    /// A WAV file is damaged or of an unsupported kind.
    #[error("{file}: {problem}")]
    Wav {
        /// File name.
        file: String,
        /// What is wrong, and where.
        problem: String,
    },
    /// An NPY file is damaged or of an unsupported kind.
    #[error("{file}: {problem}")]
    Npy {
        /// File name.
        file: String,
        /// What is wrong, and where.
        problem: String,
    },
    /// The signals are not a valid recording.
    #[error("{file}: {source}")]
    Recording {
        /// File name.
        file: String,
        /// The reason.
        source: RecordingError,
    },
    /// A setup response is invalid.
    #[error("{file}, line {line}: {problem}")]
    Response {
        /// File name.
        file: String,
        /// The line.
        line: usize,
        /// What is wrong, and what is expected.
        problem: String,
    },
    /// A motion trace is invalid.
    #[error("{file}, line {line}: {problem}")]
    Trace {
        /// File name.
        file: String,
        /// The line.
        line: usize,
        /// What is wrong, and what is expected.
        problem: String,
    },
}
