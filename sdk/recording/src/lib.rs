//! Readers of recordings: CSV, WAV, FLAC, NPY, MATLAB, TDMS, and with the feature `lab-files` Parquet, Arrow and HDF5.
//!
//! ```no_run
//! # use std::path::Path;
//! use htex_recording::{ColumnMap, ReadOptions, read_recording};
//!
//! // Columns in volts: the map assigns roles and the sensor's newtons per volt.
//! let map = "lateral=lateral_V:0.4444,normal=normal_V:0.31".parse::<ColumnMap>()?;
//! let options = ReadOptions::default().with_rate_hz(10_000.0).with_map(map);
//! let recording = read_recording(Path::new("finger.csv"), &options)?;
//! println!("{} s at {} Hz", recording.duration_s(), recording.rate_hz);
//! # Ok::<(), htex_recording::ReadError>(())
//! ```
//!
//! A format is read by a library where that checks what it reads. All readers read only the columns that are used, and
//! take no memory for a size that the file does not hold.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod columns;
mod error;
mod formats;
mod hertz;
mod input;
mod options;
mod recording;
mod response;
pub mod rules;
mod sheet;
mod sums;
mod trace;
mod tracker;
mod value_limit;
mod velocity;

use std::path::Path;

pub use columns::channel_table::{ChannelTable, read_channels};
pub use columns::expression::Expression;
pub use columns::map::{ColumnMap, ColumnRef, MapEntry, Role};
pub use columns::motion::speed_mm_s;
pub use columns::row_map::RowMap;
pub use error::ReadError;
pub use hertz::hertz;
pub use options::ReadOptions;
pub use recording::{MAX_RATE_HZ, Recording, RecordingError};
pub use response::{Raised, SetupResponse, raised, read_response, response_from_bytes};
pub use sheet::Place;
pub use sums::Sums;
pub use trace::{TraceColumns, read_trace, trace_from_bytes};
pub use tracker::Tracker;
pub use value_limit::MOST_VALUES;
pub use velocity::velocity;

use columns::assemble::assemble;
use formats::samples;
use formats::text::file_name;
use formats::with_sheet;
use input::{Input, Opened};

/// Reads a recording. The kind of file is detected by its first bytes; a file without a signature by its extension.
///
/// The recording's warnings list assumed units, gaps in time and unused columns.
///
/// # Errors
/// See [`ReadError`]: each names the file, and the place where there is one.
pub fn read_recording(path: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    options.check(&file_name(path))?;
    read_from(Opened::file(path)?, options)
}

/// Reads a recording from bytes; `path` is its name and is not opened.
///
/// # Errors
/// As [`read_recording`].
pub fn recording_from_bytes(
    path: &Path,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    options.check(&file_name(path))?;
    read_from(Opened::new(path, Input::Bytes(bytes))?, options)
}

fn read_from(opened: Opened<'_>, options: &ReadOptions) -> Result<Recording, ReadError> {
    let file = opened.file.clone();
    let assembled = match options.map {
        None => samples::read(opened, options)?,
        Some(_) => with_sheet(opened, options, |sheet| assemble(sheet, options))?,
    };
    let recording = match &options.tracker {
        None => assembled.recording,
        Some(tracker) => tracker.follow(assembled, options)?,
    };
    match (options.from_s, options.to_s) {
        (None, None) => Ok(recording),
        (from_s, to_s) => recording
            .between(from_s, to_s)
            .map_err(|source| ReadError::Recording { file, source }),
    }
}
