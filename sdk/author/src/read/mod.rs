//! Readers of recordings: CSV with named columns, WAV, and NPY.
//!
//! ```no_run
//! # use std::path::Path;
//! use htex_author::read::{ColumnMap, ReadOptions, read_recording};
//!
//! // Columns in volts: the map assigns roles and the sensor's newtons per volt.
//! let map = "lateral=lateral_V:0.4444,normal=normal_V:0.31".parse::<ColumnMap>()?;
//! let options = ReadOptions::default().with_rate_hz(10_000.0).with_map(map);
//! let recording = read_recording(Path::new("finger.csv"), &options)?;
//! println!("{} s at {} Hz", recording.duration_s(), recording.rate_hz);
//! # Ok::<(), htex_author::read::ReadError>(())
//! ```

pub(crate) mod blocks;
mod clock;
mod columns;
mod csv;
mod error;
mod map;
pub(crate) mod motion;
mod npy;
mod number;
mod select;
pub(crate) mod table;
pub(crate) mod text;
mod trace;
pub(crate) mod value_limit;
mod wav;

use std::io::Read;
use std::path::Path;

use htex_format::Quantity;

pub use error::ReadError;
pub use map::{ColumnMap, ColumnRef, MapEntry, Role};
pub use trace::{TraceColumns, read_trace, trace_from_bytes};
pub use value_limit::MOST_VALUES;

use crate::recording::{MAX_RATE_HZ, Recording, check_rate};

use blocks::Blocks;
use value_limit::ValueLimit;

/// Options of reading, for what a file does not state.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Sample rate, hertz. Required for NPY and for a CSV without time column. It takes precedence over a time
    /// column and must equal a WAV's own rate.
    pub rate_hz: Option<f64>,
    /// Roles of CSV columns; columns that it leaves out are assigned by their names.
    pub map: Option<ColumnMap>,
    /// Quantity of the texture's signal.
    pub quantity: Quantity,
    /// Value of a full-scale (1.0) sample in WAV and NPY, in the quantity's unit; 1 with a warning when absent.
    pub scale: Option<f64>,
    /// Start of the part to read, seconds of the file.
    pub from_s: Option<f64>,
    /// End of the part to read, seconds of the file.
    pub to_s: Option<f64>,
    /// Limit on the numbers kept in memory; [`MOST_VALUES`] when absent. Unused columns do not count.
    pub most_values: Option<usize>,
}

impl ReadOptions {
    /// Sets the sample rate, hertz.
    #[must_use]
    pub fn with_rate_hz(mut self, rate_hz: impl Into<Option<f64>>) -> Self {
        self.rate_hz = rate_hz.into();
        self
    }

    /// Sets the roles of CSV columns.
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

    /// Sets the value of a full-scale sample in WAV and NPY.
    #[must_use]
    pub fn with_scale(mut self, scale: impl Into<Option<f64>>) -> Self {
        self.scale = scale.into();
        self
    }

    /// Sets the start of the part to read, seconds of the file.
    #[must_use]
    pub fn with_from_s(mut self, from_s: impl Into<Option<f64>>) -> Self {
        self.from_s = from_s.into();
        self
    }

    /// Sets the end of the part to read, seconds of the file.
    #[must_use]
    pub fn with_to_s(mut self, to_s: impl Into<Option<f64>>) -> Self {
        self.to_s = to_s.into();
        self
    }

    /// Sets the limit on the numbers kept in memory.
    #[must_use]
    pub fn with_most_values(mut self, most_values: impl Into<Option<usize>>) -> Self {
        self.most_values = most_values.into();
        self
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Csv,
    Wav,
    Npy,
}

/// Reads a recording. The kind of file is detected by its first bytes; a file without a signature by its extension.
///
/// The recording's warnings list assumed units, gaps in time and unused columns.
///
/// # Errors
/// See [`ReadError`]: each names the file, and the line and column where there is one.
pub fn read_recording(path: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    read_from(path, || text::open(path), options)
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
    read_from(path, || Ok(bytes), options)
}

fn read_from<R: Read>(
    path: &Path,
    open: impl FnOnce() -> Result<R, ReadError>,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    let file = text::file_name(path);
    check_options(&file, options)?;
    let most_values = options.most_values.unwrap_or(MOST_VALUES);
    let mut blocks = Blocks::new(&file, open()?, ValueLimit { most_values });
    let recording = match kind(path, blocks.front()?) {
        Kind::Csv => csv::read(blocks, options),
        Kind::Wav => wav::read(blocks, options),
        Kind::Npy => npy::read(blocks, options),
    }?;
    match (options.from_s, options.to_s) {
        (None, None) => Ok(recording),
        (from_s, to_s) => recording
            .between(from_s, to_s)
            .map_err(|source| ReadError::Recording { file, source }),
    }
}

/// Detects the kind of file by its signature, else by its extension; the default is text.
fn kind(path: &Path, bytes: &[u8]) -> Kind {
    if bytes.starts_with(b"RIFF") {
        return Kind::Wav;
    }
    if bytes.starts_with(b"\x93NUMPY") {
        return Kind::Npy;
    }
    let extension = path
        .extension()
        .map(|extension| extension.to_ascii_lowercase());
    match extension.as_deref().and_then(std::ffi::OsStr::to_str) {
        Some("wav" | "wave") => Kind::Wav,
        Some("npy") => Kind::Npy,
        _ => Kind::Csv,
    }
}

fn check_options(file: &str, options: &ReadOptions) -> Result<(), ReadError> {
    let refuse = |option, problem| {
        Err(ReadError::Option {
            file: file.to_owned(),
            option,
            problem,
        })
    };
    match (options.rate_hz, options.scale) {
        (Some(rate), _) if check_rate(rate).is_err() => refuse(
            "rate_hz",
            format!(
                "the given sample rate is {rate}; it must be above 0 and at most {MAX_RATE_HZ} Hz"
            ),
        ),
        (_, Some(scale)) if !scale.is_finite() || scale == 0.0 => refuse(
            "scale",
            format!("the given scale is {scale}; it must be finite and not 0"),
        ),
        _ => Ok(()),
    }
}

/// Refuses a column map for files without named columns.
fn refuse_map(file: &str, options: &ReadOptions) -> Result<(), ReadError> {
    match options.map {
        None => Ok(()),
        Some(_) => Err(ReadError::Option {
            file: file.to_owned(),
            option: "map",
            problem: "a column map is for CSV; in WAV and NPY the channels are lateral, or lateral x, y, or x, y, normal; of a motion \
                  they are its axes"
                .into(),
        }),
    }
}

/// Returns the warning about samples without a scale.
fn assumption(is_integer: bool, quantity: Quantity) -> String {
    let unit = quantity.unit();
    if is_integer {
        format!("Integer full scale is assumed to be 1 {unit}; give the scale if it is not.")
    } else {
        format!("Samples are assumed to be in {unit}; give the scale if they are not.")
    }
}

/// Assigns channels. Of a force: one is lateral, two are lateral x and y, three are x, y and normal. Of other
/// quantities the channels are axes. Scales to the quantity's unit.
fn from_channels(
    file: &str,
    rate_hz: f64,
    mut channels: Vec<Vec<f64>>,
    options: &ReadOptions,
) -> Result<Recording, ReadError> {
    let scale = options.scale.unwrap_or(1.0);
    if scale != 1.0 {
        channels
            .iter_mut()
            .flatten()
            .for_each(|value| *value *= scale);
    }
    let normal = match (options.quantity, &channels[..]) {
        (Quantity::LateralForce, [_, _, _]) => channels.pop(),
        (Quantity::NormalForce, [axis]) => Some(axis.clone()),
        _ => None,
    };
    let recording = Recording::of(options.quantity, file, rate_hz, channels);
    match normal {
        None => recording,
        Some(normal) => recording.and_then(|recording| recording.with_normal(normal)),
    }
    .map_err(|source| ReadError::Recording {
        file: file.to_owned(),
        source,
    })
}
