//! What can be wrong with a recording's file, and what its author can do about it.

use std::io;

use thiserror::Error;

use crate::recording::RecordingError;

/// Why a file could not be read as a recording or a setup response.
///
/// Lines are counted from 1 as an editor shows them. `file` is the name without its directory.
#[derive(Debug, Error)]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {source}")]
    Io {
        /// File name.
        file: String,
        /// The system's reason.
        source: io::Error,
    },
    /// The file is larger than any recording.
    #[error(
        "{file}: {bytes} bytes is more than the limit of {limit}; cut the recording into parts"
    )]
    TooLarge {
        /// File name.
        file: String,
        /// The file's size.
        bytes: u64,
        /// The largest size that is read.
        limit: u64,
    },
    /// The file holds more numbers than are kept in memory.
    #[error(
        "{file}: it holds more than {limit} numbers, which are as many as are kept in memory; cut the recording into \
         parts, or raise the limit by --most-numbers"
    )]
    TooManyValues {
        /// File name.
        file: String,
        /// Most numbers that are kept.
        limit: usize,
    },
    /// The file has no rows at all.
    #[error("{file}: the file holds no data; expected a header row and at least 2 rows of numbers")]
    Empty {
        /// File name.
        file: String,
    },
    /// The header is there, the rows are not.
    #[error("{file}: {rows} row(s) of numbers after the header; a recording needs at least 2")]
    TooFewRows {
        /// File name.
        file: String,
        /// Rows found.
        rows: usize,
    },
    /// NUL bytes or invalid UTF-8.
    #[error(
        "{file}, line {line}: {what}, which is not text; give a CSV saved as UTF-8, a WAV or an NPY file"
    )]
    NotText {
        /// File name.
        file: String,
        /// Line of the first such byte.
        line: usize,
        /// Which byte.
        what: &'static str,
    },
    /// A line longer than any row of numbers.
    #[error(
        "{file}, line {line}: {bytes} bytes in one line, more than the limit of {limit}; one row a line is expected"
    )]
    LongLine {
        /// File name.
        file: String,
        /// The line.
        line: usize,
        /// Its length in bytes.
        bytes: usize,
        /// The longest that is read.
        limit: usize,
    },
    /// A row with another number of cells than the header.
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
        /// Cells in this one.
        got: usize,
    },
    /// The last line is shorter than the others.
    #[error(
        "{file}, line {line}: the file seems cut off: its last line has {got} of {expected} cells; copy the file again or delete that line"
    )]
    CutOff {
        /// File name.
        file: String,
        /// The line.
        line: usize,
        /// Cells in the first row.
        expected: usize,
        /// Cells in the last one.
        got: usize,
    },
    /// A cell that is not a finite number.
    #[error(
        "{file}, line {line}, column {column:?}: {problem}; every sample must be a finite number with a decimal point"
    )]
    Cell {
        /// File name.
        file: String,
        /// The line.
        line: usize,
        /// The column's name, or `#` and its number.
        column: String,
        /// What the cell holds.
        problem: String,
    },
    /// The columns do not say which is which.
    #[error("{file}: {problem}; the columns are: {columns}")]
    Columns {
        /// File name.
        file: String,
        /// What is missing or unclear, and what to give.
        problem: String,
        /// The columns there are.
        columns: String,
    },
    /// A column map that cannot be understood.
    #[error(
        "column map: {problem}; write ROLE=COLUMN[:SCALE], comma separated, as in lateral=lateral_V:0.4444,normal=#3"
    )]
    Map {
        /// What is wrong.
        problem: String,
    },
    /// A time column that does not run forward.
    #[error(
        "{file}, line {line}: time goes from {before} s to {after} s; it must grow on every row (a column with too few decimals repeats itself); repair the column, or give --rate HZ to go without it"
    )]
    Time {
        /// File name.
        file: String,
        /// The line of the later time.
        line: usize,
        /// Time of the row before, seconds.
        before: f64,
        /// Time of this row, seconds.
        after: f64,
    },
    /// Nothing tells the sample rate.
    #[error("{file}: nothing in it tells the sample rate; give --rate HZ")]
    NoRate {
        /// File name.
        file: String,
    },
    /// An option that does not go with this kind of file.
    #[error("{file}: {problem}")]
    Option {
        /// File name.
        file: String,
        /// Which option, and what to do instead.
        problem: String,
    },
    /// A WAV file that is broken or of another kind than is read.
    #[error("{file}: {problem}")]
    Wav {
        /// File name.
        file: String,
        /// What, and where.
        problem: String,
    },
    /// An NPY file that is broken or of another kind than is read.
    #[error("{file}: {problem}")]
    Npy {
        /// File name.
        file: String,
        /// What, and where.
        problem: String,
    },
    /// The signals make no recording.
    #[error("{file}: {source}")]
    Recording {
        /// File name.
        file: String,
        /// Why.
        source: RecordingError,
    },
    /// A setup response that makes no sense.
    #[error("{file}, line {line}: {problem}")]
    Response {
        /// File name.
        file: String,
        /// The line.
        line: usize,
        /// What, and what is expected.
        problem: String,
    },
    /// A motion trace that makes no sense.
    #[error("{file}, line {line}: {problem}")]
    Trace {
        /// File name.
        file: String,
        /// The line.
        line: usize,
        /// What, and what is expected.
        problem: String,
    },
}
