//! Errors of devices and sources.

/// An error of an adapter or an open device.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// A setting is not known, missing, or not usable.
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
         A carrier prevents it; for a rig that has none, a person gives the `setting dc_limit_v=VOLTS`"
    )]
    DirectVoltage {
        /// Index of the sample since the device was opened.
        frame: u64,
        mean_v: f64,
        limit_v: f64,
    },
    /// The device ran dry: samples came too late. The output is at zero.
    #[error("{device} ran dry after {frames} frames; {advice}")]
    Underflow {
        device: String,
        /// Frames that were output before.
        frames: u64,
        advice: String,
    },
    /// A source lost frames because they were read too late. It delivers nothing more.
    #[error("{source_name} lost samples after {frames} frames, which were read too late; {advice}")]
    Overrun {
        source_name: String,
        /// Frames that were delivered before.
        frames: u64,
        advice: String,
    },
    /// A complete message from a library, or from another process that holds the device.
    #[error("{0}")]
    Told(String),
    /// The device was removed, or its driver failed.
    #[error("{device} failed: {what}")]
    Failed {
        device: String,
        /// The driver's message.
        what: String,
    },
    /// A call came after `finish` or `stop`, or after an error.
    #[error("{0} is closed")]
    Closed(String),
    /// A file could not be written or read.
    #[error("{path}: {what}")]
    File { path: String, what: String },
    /// No device of this name is known.
    #[error("no device `{wanted}`; there are {known}")]
    Unknown { wanted: String, known: String },
    /// No source of this name is known.
    #[error("no source `{wanted}`; there are {known}")]
    UnknownSource { wanted: String, known: String },
    /// A library is not a device or source of this ABI, or violates the ABI.
    #[error("{library}: {fault}")]
    Abi { library: String, fault: AbiFault },
}

/// How a library fails to be a device or source of this ABI.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AbiFault {
    /// The system cannot load the file. Contains the system's reason.
    #[error("{0}")]
    NotLoaded(String),
    /// The marker belongs to another major version of the ABI, or to another ABI.
    #[error("the marker {marker:#x} is not of {kind} ABI {major}.x, which this host loads")]
    Marker {
        marker: u32,
        /// `device` or `source`.
        kind: &'static str,
        /// The major version that this host loads.
        major: u32,
    },
    /// A function of the ABI is missing.
    #[error("the library has no `{symbol}`; it is not an htex {kind}")]
    Symbol {
        symbol: &'static str,
        /// `device` or `source`.
        kind: &'static str,
    },
    /// The descriptor cannot be read, or is invalid.
    #[error("descriptor: {0}")]
    Descriptor(String),
    /// A call returned a result that the ABI forbids, or refused arguments that the ABI allows.
    #[error("{0}")]
    Call(String),
}
