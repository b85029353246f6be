//! The frozen source ABI: the numbers and signatures between a host and a native source.
//!
//! Texts, settings and results cross as in the ABI of [devices](crate::abi). Samples are `f64` and
//! interleaved: frame after frame, and within a frame one sample of each channel.

use crate::abi as device;
pub use crate::abi::{AbiVersion, DescriptorJson, EndpointsJson, ExtensionFn, LastError};

/// Major version: a host loads only sources of its own major version.
pub const ABI_MAJOR: u32 = 1;
/// Minor version: grows with optional exports.
pub const ABI_MINOR: u32 = 0;
/// The marker that a source returns: a fixed upper half, then one byte each for major and minor
/// version.
pub const ABI_MARKER: u32 = 0x4853_0000 | (ABI_MAJOR << 8) | ABI_MINOR;

/// Maximum length of any text in either direction, bytes.
pub const MAX_TEXT_BYTES: usize = device::MAX_TEXT_BYTES;
/// Maximum number of settings in a descriptor, and of profiles.
pub const MAX_SETTINGS: usize = device::MAX_SETTINGS;
/// Maximum number of channels of a source. The minimum is one.
pub const MAX_CHANNELS: usize = 1_024;
/// Maximum length of a channel's name or unit, bytes.
pub const MAX_NAME_BYTES: usize = 256;
/// Lowest rate of a source, hertz.
pub const MIN_RATE_HZ: f64 = 0.001;
/// Highest rate of a source, hertz.
pub const MAX_RATE_HZ: f64 = 10_000_000.0;

/// Negative results of calls. The numbers are frozen, because they are part of the ABI. Codes that
/// devices also have use the same numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum Code {
    /// The call succeeded.
    Ok = 0,
    /// A pointer or length is not usable, or a text is not UTF-8.
    InvalidArgument = -1,
    /// A setting is not known, missing, or not usable; the text begins with `NAME: `.
    InvalidSetting = -2,
    /// The source does not sample at this rate.
    InvalidRate = -3,
    /// A driver is not installed, or no such source is connected.
    Missing = -4,
    /// The source is in use.
    Busy = -5,
    /// Frames were lost because they were read too late. The text says what to do.
    Overrun = -6,
    /// The source has ended, as a file does; there are no more frames.
    End = -7,
    /// The source was not started, or the call came after it was stopped or after an error.
    Closed = -8,
    /// A file could not be read; the text begins with `PATH: `.
    File = -9,
    /// No such source is open, or it was closed.
    BadHandle = -10,
    /// The source's code panicked.
    Panicked = -11,
    /// Any other failure; see the last-error text.
    Failed = -12,
}

impl Code {
    /// Converts a number that crossed the ABI to its code. Unknown negative numbers are `Failed`.
    pub fn from_answer(answer: i64) -> Self {
        match answer {
            0.. => Self::Ok,
            -1 => Self::InvalidArgument,
            -2 => Self::InvalidSetting,
            -3 => Self::InvalidRate,
            -4 => Self::Missing,
            -5 => Self::Busy,
            -6 => Self::Overrun,
            -7 => Self::End,
            -8 => Self::Closed,
            -9 => Self::File,
            -10 => Self::BadHandle,
            -11 => Self::Panicked,
            _ => Self::Failed,
        }
    }
}

/// Opens a source, which does not sample yet. Returns its handle, greater than zero.
/// `[any thread; may wait]`
pub type OpenFn = unsafe extern "C" fn(settings: *const u8, settings_len: usize) -> i64;
/// Writes the rate and the channels of an open source as JSON. Returns the length, which is the
/// same at each call. `[one thread at a time for one source]`
pub type StreamJson = unsafe extern "C" fn(source: i64, out: *mut u8, capacity: usize) -> i64;
/// Starts sampling; returns 0. `[one thread at a time for one source; may wait]`
pub type StartFn = extern "C" fn(source: i64) -> i64;
/// Writes the available frames to `samples[0..len]` and returns their number. Waits up to
/// `timeout_ms` for the first frame. `len` is a multiple of the number of channels.
/// `[one thread at a time for one source; may wait]`
pub type ReadFn =
    unsafe extern "C" fn(source: i64, samples: *mut f64, len: usize, timeout_ms: u32) -> i64;
/// Stops sampling for good; returns 0. `[one thread at a time for one source; may wait]`
pub type StopFn = extern "C" fn(source: i64) -> i64;
/// Closes a source, and stops it if it is sampling; returns 0.
/// `[one thread at a time for one source]`
pub type CloseFn = extern "C" fn(source: i64) -> i64;

/// The table of all functions that a native source exports. It is filled from symbols of the same
/// names (`htex_source_…`).
#[derive(Clone, Copy)]
#[repr(C)]
#[allow(missing_docs)] // Each type says what its function does.
pub struct SourceTable {
    pub abi_version: AbiVersion,
    pub descriptor: DescriptorJson,
    pub last_error: LastError,
    pub endpoints: EndpointsJson,
    pub open: OpenFn,
    pub stream: StreamJson,
    pub start: StartFn,
    pub read: ReadFn,
    pub stop: StopFn,
    pub close: CloseFn,
    pub extension: ExtensionFn,
}
