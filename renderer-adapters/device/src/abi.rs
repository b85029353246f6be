//! The frozen device ABI: the numbers and signatures between a host and a native device.
//!
//! Only scalars and pointer + length cross. A function that returns a text writes to the caller's
//! buffer and returns the length needed. If the buffer is too small, the caller calls again.
//! Negative results are [`Code`]s. Settings cross as UTF-8 lines, each `name=value` and a line end,
//! in the order of the descriptor. The host passes all of them, with profiles and defaults already
//! resolved.

/// Major version: a host loads only devices of its own major version.
pub const ABI_MAJOR: u32 = 1;
/// Minor version: grows with optional exports.
pub const ABI_MINOR: u32 = 0;
/// The marker that a device returns: a fixed upper half, then one byte each for major and minor
/// version.
pub const ABI_MARKER: u32 = 0x4844_0000 | (ABI_MAJOR << 8) | ABI_MINOR;

/// Maximum length of any text in either direction, bytes.
pub const MAX_TEXT_BYTES: usize = 1_048_576;
/// Maximum number of settings in a descriptor, and of profiles.
pub const MAX_SETTINGS: usize = 64;
/// Lowest rate of a device, hertz.
pub const MIN_RATE_HZ: f64 = 1.0;
/// Highest rate of a device, hertz.
pub const MAX_RATE_HZ: f64 = 10_000_000.0;
/// Maximum number of frames in a block that a device asks for or is opened for. The minimum is one.
pub const MAX_BLOCK_FRAMES: u32 = 1_048_576;

/// Index of the status number: frames that the device took since it was opened.
pub const STATUS_FRAMES_WRITTEN: usize = 0;
/// Index of the status number: frames that were output.
pub const STATUS_FRAMES_PLAYED: usize = 1;
/// Index of the status number: how often the device ran dry.
pub const STATUS_UNDERRUNS: usize = 2;
/// Index of the status number: time from writing a sample to its output, seconds.
pub const STATUS_LATENCY_S: usize = 3;
/// Index of the status number: largest magnitude that the device took, in the quantity's unit.
pub const STATUS_PEAK: usize = 4;
/// Number of status numbers. Every device has all of them.
pub const STATUS_NUMBERS: usize = 5;

/// Negative results of calls. The numbers are frozen, because they are part of the ABI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum Code {
    /// The call succeeded.
    Ok = 0,
    /// A pointer, length or block size is not usable, or a text is not UTF-8.
    InvalidArgument = -1,
    /// A setting is not known, missing, or not usable; the text begins with `NAME: `.
    InvalidSetting = -2,
    /// The device does not run at this rate.
    InvalidRate = -3,
    /// A driver is not installed, or no such device is connected.
    Missing = -4,
    /// The device is in use.
    Busy = -5,
    /// A sample is over the limit or not a number; the output is at zero.
    OverLimit = -6,
    /// The device ran dry; the output is at zero. The text says what to do.
    Underflow = -7,
    /// The call came after `finish` or after an error.
    Closed = -8,
    /// A file could not be written; the text begins with `PATH: `.
    File = -9,
    /// No such device is open, or it was closed.
    BadHandle = -10,
    /// The device's code panicked; the output is at zero.
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
            -6 => Self::OverLimit,
            -7 => Self::Underflow,
            -8 => Self::Closed,
            -9 => Self::File,
            -10 => Self::BadHandle,
            -11 => Self::Panicked,
            _ => Self::Failed,
        }
    }
}

/// Returns [`ABI_MARKER`]. `[any thread]`
pub type AbiVersion = extern "C" fn() -> u32;
/// Writes the descriptor as UTF-8 JSON to `out[0..capacity]`. Returns the length, which is the same
/// at each call. `[any thread]`
pub type DescriptorJson = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Writes the text of the calling thread's last error. Returns the length. `[any thread]`
pub type LastError = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Writes a JSON array of the devices that are connected now. Returns the length, which may change.
/// `[any thread; may wait]`
pub type EndpointsJson = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Writes as JSON what a device with these settings can do. Returns the length. Opens nothing.
/// `[any thread; may wait]`
pub type CapabilitiesJson = unsafe extern "C" fn(
    settings: *const u8,
    settings_len: usize,
    out: *mut u8,
    capacity: usize,
) -> i64;
/// Opens a device for blocks of `block_frames`, silent and with its output at zero. Returns its
/// handle, greater than zero. `[any thread; may wait]`
pub type OpenFn = unsafe extern "C" fn(
    settings: *const u8,
    settings_len: usize,
    rate_hz: f64,
    block_frames: u32,
) -> i64;
/// Takes as many samples as fit within `timeout_ms` (0: those that fit now) and returns their
/// number. The first samples start the device. `[one thread at a time for one device; may wait]`
pub type WriteFn =
    unsafe extern "C" fn(device: i64, samples: *const f32, frames: usize, timeout_ms: u32) -> i64;
/// Writes the status numbers at the indices `STATUS_…`, at most `capacity` of them. Returns how
/// many the device has. `[one thread at a time for one device]`
pub type StatusFn = unsafe extern "C" fn(device: i64, out: *mut f64, capacity: usize) -> i64;
/// Plays all written samples, goes to zero and keeps the result; returns 0.
/// `[one thread at a time for one device; may wait]`
pub type FinishFn = extern "C" fn(device: i64) -> i64;
/// Closes a device; returns 0. Without [`FinishFn`] before, it aborts: the output goes to zero at
/// once, and an unfinished file is removed. `[one thread at a time for one device]`
pub type CloseFn = extern "C" fn(device: i64) -> i64;
/// Returns 1 if the extension named by UTF-8 `id` (`htex.NAME/REV`, `com.vendor.NAME/REV`) is
/// present, else 0. `[any thread]`
pub type ExtensionFn = unsafe extern "C" fn(id: *const u8, id_len: usize) -> i64;

/// The table of all functions that a native device exports. It is filled from symbols of the same
/// names (`htex_device_…`).
#[derive(Clone, Copy)]
#[repr(C)]
#[allow(missing_docs)] // Each type says what its function does.
pub struct DeviceTable {
    pub abi_version: AbiVersion,
    pub descriptor: DescriptorJson,
    pub last_error: LastError,
    pub endpoints: EndpointsJson,
    pub capabilities: CapabilitiesJson,
    pub open: OpenFn,
    pub write: WriteFn,
    pub status: StatusFn,
    pub finish: FinishFn,
    pub close: CloseFn,
    pub extension: ExtensionFn,
}
