//! Errors of devices.

use crate::Direction;

/// An error of an adapter or an open device.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// A setting is unknown, missing or invalid.
    #[error("setting `{name}`: {what}")]
    Setting {
        name: String,
        /// What is wrong, and which values are allowed.
        what: String,
    },
    /// The device does not run at this rate.
    #[error("{device} does not run at {rate_hz} Hz; it runs at {rates}")]
    Rate { device: String, rate_hz: f64, rates: String },
    /// A driver is not installed, or no such device is connected.
    #[error("{0}")]
    Missing(String),
    /// The device is in use.
    #[error("{0}")]
    Busy(String),
    /// A sample is beyond the device's limit or not a number; the output is at zero.
    #[error(
        "sample {frame} is {value} {unit}, and the limit is {limit} {unit}; the output is at zero"
    )]
    OverLimit {
        /// Index of the sample since the device was opened.
        frame: u64,
        value: f64,
        limit: f64,
        /// Symbol of the unit.
        unit: &'static str,
    },
    /// The mean of a display's voltage over 100 ms is beyond its limit; the output is at zero.
    #[error(
        "sample {frame} makes a direct voltage of {mean_v:.3} V over 100 ms, and the limit is {limit_v} V; the output is at zero. \
         A carrier prevents direct voltage; for a rig without a carrier, set `dc_limit_v=VOLTS` yourself"
    )]
    DirectVoltage {
        /// Index of the sample since the device was opened.
        frame: u64,
        mean_v: f64,
        limit_v: f64,
    },
    /// The samples for the output came too late, so the device had none to play. The output is at
    /// zero.
    #[error("{device} ran dry after {frames} frames; {advice}")]
    Underflow {
        device: String,
        /// Frames that had been played before.
        frames: u64,
        advice: String,
    },
    /// An input lost frames because they were read too late. The input delivers no more frames.
    #[error("{device} lost samples after {frames} frames, which were read too late; {advice}")]
    Overrun {
        device: String,
        /// Frames that had been delivered before.
        frames: u64,
        advice: String,
    },
    /// A complete message from a library, or from the process that holds the device.
    #[error("{0}")]
    Message(String),
    /// The device was removed, or its driver failed.
    #[error("{device} failed: {what}")]
    Failed {
        device: String,
        /// The driver's message.
        what: String,
    },
    /// A call came before `start`, after `finish`, or after an error.
    #[error("{0} is closed")]
    Closed(String),
    /// A file could not be written or read.
    #[error("{path}: {what}")]
    File { path: String, what: String },
    /// No device of this name and direction is known.
    #[error("no {} `{wanted}`; there are {known}", noun(.direction))]
    Unknown { direction: Direction, wanted: String, known: String },
    /// The device has the wrong direction. A caller tried to play on an input, or to record from an
    /// output.
    #[error("{device} is not an {wanted}; choose another device")]
    Direction { device: String, wanted: Direction },
    /// The descriptor, the capabilities or the stream that an adapter returned is invalid.
    #[error("{document}: {what}")]
    Invalid {
        /// `descriptor`, `capabilities` or `stream`.
        document: &'static str,
        what: String,
    },
    /// A library is not a device of this ABI, or violates the ABI.
    #[error("{library}: {what}")]
    Library { library: String, fault: LibraryFault, what: String },
}

/// The way in which a library violates the ABI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LibraryFault {
    /// The system cannot load the file.
    Load,
    /// The library has no table, or a table of another major version of the ABI.
    Marker,
    /// The table lacks a function that a device of its direction needs.
    Function,
    /// The descriptor cannot be read, or is invalid.
    Descriptor,
    /// A call returned a result that the ABI forbids, or refused arguments that the ABI allows.
    Answer,
}

impl DeviceError {
    /// Creates the error for a setting that is unknown, missing or invalid. `what` states the
    /// problem and the allowed values.
    pub fn setting(name: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Setting { name: name.into(), what: what.into() }
    }
}

/// Returns the word for a device in the message that it was not found.
fn noun(direction: &Direction) -> &'static str {
    match direction {
        Direction::Output => "device",
        Direction::Input => "input",
    }
}
