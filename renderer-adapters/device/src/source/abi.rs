//! The frozen surface: numbers and signatures that cross between a host and a native source.
//!
//! Texts, settings and results cross as those of [devices](crate::abi) do. Samples are `f64`, the
//! frames one after another, and in a frame one sample of each channel.

use crate::abi as device;
pub use crate::abi::{AbiVersion, DescriptorJson, EndpointsJson, ExtensionFn, LastError};

/// Major part of the version: a host loads only sources of its own major.
pub const ABI_MAJOR: u32 = 1;
/// Minor part: grows with optional exports.
pub const ABI_MINOR: u32 = 0;
/// The marker that a source returns: a fixed upper half, then major and minor in a byte each.
pub const ABI_MARKER: u32 = 0x4853_0000 | (ABI_MAJOR << 8) | ABI_MINOR;

/// Most bytes any text may have, one way or the other.
pub const MAX_TEXT_BYTES: usize = device::MAX_TEXT_BYTES;
/// Most settings a descriptor may have, and most profiles.
pub const MAX_SETTINGS: usize = device::MAX_SETTINGS;
/// Most channels of a source; the least is one.
pub const MAX_CHANNELS: usize = 1_024;
/// Most bytes of a channel's name or unit.
pub const MAX_NAME_BYTES: usize = 256;
/// Lowest rate of a source, hertz.
pub const MIN_RATE_HZ: f64 = 0.001;
/// Highest rate of a source, hertz.
pub const MAX_RATE_HZ: f64 = 10_000_000.0;

/// Negative results of calls. Frozen numbers: they are part of the ABI. Those that devices have too
/// have the same numbers.
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
    /// The source was not started, or the call came after its stop or after an error.
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
    /// The code of a number that crossed the ABI; unknown negative numbers are `Failed`.
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

/// Opens a source, which does not sample yet; returns its handle, greater than zero.
/// `[any thread; may wait]`
pub type OpenFn = unsafe extern "C" fn(settings: *const u8, settings_len: usize) -> i64;
/// Writes the rate and the channels of an open source, as JSON; returns its length, the same at
/// each call. `[one thread at a time for one source]`
pub type StreamJson = unsafe extern "C" fn(source: i64, out: *mut u8, capacity: usize) -> i64;
/// Begins to sample; returns 0. `[one thread at a time for one source; may wait]`
pub type StartFn = extern "C" fn(source: i64) -> i64;
/// Writes frames to `samples[0..len]`, those that are there, and waits up to `timeout_ms` for the
/// first; returns their number. `len` is a multiple of the number of channels.
/// `[one thread at a time for one source; may wait]`
pub type ReadFn =
    unsafe extern "C" fn(source: i64, samples: *mut f64, len: usize, timeout_ms: u32) -> i64;
/// Stops sampling for good; returns 0. `[one thread at a time for one source; may wait]`
pub type StopFn = extern "C" fn(source: i64) -> i64;
/// Closes a source, and stops it if it samples; returns 0. `[one thread at a time for one source]`
pub type CloseFn = extern "C" fn(source: i64) -> i64;

/// Everything a native source exports, in one table: filled from symbols of the same names
/// (`htex_source_…`).
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
