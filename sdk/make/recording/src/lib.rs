//! Recordings of a finger sliding on a texture, and the readers of their files. The crate always
//! reads CSV. To read another of the [`FORMATS`], enable the Cargo feature of that format.
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
//! This crate uses an existing library for a format only if the library validates its input. For
//! all other formats, this crate has its own readers. All readers skip columns that are not used.
//! If a file states a size that is larger than its contents, no reader allocates memory for the
//! stated size.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(all(
        feature = "flac",
        feature = "matlab",
        feature = "npy",
        feature = "tdms",
        feature = "wav"
    )),
    allow(dead_code, reason = "readers share what some builds do not need")
)]

mod columns;
mod error;
mod follow;
mod formats;
mod hash;
mod hertz;
mod input;
mod options;
mod preview;
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
pub use columns::clock::clock_definition;
pub use columns::expression::Expression;
pub use columns::map::{ColumnMap, MapEntry, Role};
pub use columns::motion::speed_mm_s;
pub use columns::row_map::RowMap;
pub use columns::token::ColumnRef;
pub use error::{Place, ReadError, ReadProblem};
pub use formats::{FORMATS, Format, format_names};
pub use hash::RecordedFile;
pub use hertz::hertz;
pub use options::ReadOptions;
pub use preview::{Preview, PreviewColumn, preview};
pub use recording::{MAX_RATE_HZ, Recording, RecordingError};
pub use response::{RaisedRanges, SetupResponse, raised, read_response, response_from_bytes};
pub use sums::Sums;
pub use trace::{
    StrokeColumns, TraceColumns, read_stroke, read_trace, stroke_from_bytes, trace_from_bytes,
};
pub use tracker::Tracker;
pub use value_limit::MOST_VALUES;
pub use velocity::velocity;

use columns::assemble::assemble;
use error::Fault;
use follow::follow;
use input::{InputFile, file_name};

/// Reads a recording. The reader detects the kind of a file by the file's first bytes, or by its
/// extension if the first bytes are not a known signature.
///
/// The recording's warnings list assumed units, gaps in time and unused columns.
///
/// # Errors
/// See [`ReadError`]. Every error names the file. If the problem is at one place in the file, the
/// error also names this place.
pub fn read_recording(path: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    // This call comes before the file is read. If the file changes during the reading, the hash is
    // then unknown instead of wrong.
    let file = RecordedFile::of_path(path);
    let recording = read(path, || InputFile::file(path), options)?;
    Ok(Recording { file, ..recording })
}

/// Reads a recording from bytes in memory. `path` supplies the file's name and extension, and is
/// not opened.
///
/// # Errors
/// Returns the same errors as [`read_recording`].
pub fn recording_from_bytes(
    path: &Path,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    let recording = read(path, || InputFile::bytes(path, bytes), options)?;
    let file = RecordedFile::of_bytes(bytes);
    Ok(Recording { file, ..recording })
}

fn read<'a>(
    path: &Path,
    open: impl FnOnce() -> Result<InputFile<'a>, Fault>,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    let file = file_name(path);
    let assembled = || {
        options.check()?;
        let mut sheet = formats::open(open()?, options)?;
        assemble(&file, &mut *sheet, options)
    };
    let assembled = assembled().map_err(|fault: Fault| fault.in_file(&file))?;
    let recording = match &options.tracker {
        None => assembled.recording,
        Some(tracker) => follow(tracker, assembled, options)?,
    };
    match (options.from_s, options.to_s) {
        (None, None) => Ok(recording),
        (from_s, to_s) => recording
            .between(from_s, to_s)
            .map_err(|error| ReadProblem::Recording(error).in_file(&file)),
    }
}
