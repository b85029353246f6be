//! The frozen surface: numbers and signatures that cross between a host and a native device.
//!
//! Only scalars and pointer + length cross. Functions that give text take the caller's buffer and
//! return the length needed; a caller with too small a buffer calls again. Negative results are
//! [`Code`]s. Settings cross as UTF-8 lines, `name=value` and a line end each, in the order of the
//! descriptor: all of them, profiles and defaults already resolved.

/// Major part of the version: a host loads only devices of its own major.
pub const ABI_MAJOR: u32 = 1;
/// Minor part: grows with optional exports.
pub const ABI_MINOR: u32 = 0;
/// The marker that a device returns: a fixed upper half, then major and minor in a byte each.
pub const ABI_MARKER: u32 = 0x4844_0000 | (ABI_MAJOR << 8) | ABI_MINOR;

/// Most bytes any text may have, one way or the other.
pub const MAX_TEXT_BYTES: usize = 1_048_576;
/// Most settings a descriptor may have, and most profiles.
pub const MAX_SETTINGS: usize = 64;
/// Lowest rate of a device, hertz.
pub const MIN_RATE_HZ: f64 = 1.0;
/// Highest rate of a device, hertz.
pub const MAX_RATE_HZ: f64 = 10_000_000.0;
/// Most frames a block may have that a device asks for or is opened for; the least is one.
pub const MAX_BLOCK_FRAMES: u32 = 1_048_576;

/// Index of the status number: frames taken since the device was opened.
pub const STATUS_FRAMES_WRITTEN: usize = 0;
/// Index of the status number: frames that came out.
pub const STATUS_FRAMES_PLAYED: usize = 1;
/// Index of the status number: times the device ran dry.
pub const STATUS_UNDERRUNS: usize = 2;
/// Index of the status number: seconds from writing a sample to its coming out.
pub const STATUS_LATENCY_S: usize = 3;
/// Index of the status number: largest magnitude taken, in the quantity's unit.
pub const STATUS_PEAK: usize = 4;
/// Number of status numbers; every device has them all.
pub const STATUS_NUMBERS: usize = 5;

/// Negative results of calls. Frozen numbers: they are part of the ABI.
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
    /// The call came after the end or after an error.
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
    /// The code of a number that crossed the ABI; unknown negative numbers are `Failed`.
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
/// Writes the descriptor as UTF-8 JSON to `out[0..capacity]`; returns its length, the same at each
/// call. `[any thread]`
pub type DescriptorJson = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Writes the text of the calling thread's last error; returns its length. `[any thread]`
pub type LastError = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Writes the devices that are connected now, a JSON array; returns its length, which may change.
/// `[any thread; may wait]`
pub type EndpointsJson = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Writes the capabilities of a device with these settings, as JSON; returns its length. Opens
/// nothing. `[any thread; may wait]`
pub type CapabilitiesJson = unsafe extern "C" fn(
    settings: *const u8,
    settings_len: usize,
    out: *mut u8,
    capacity: usize,
) -> i64;
/// Opens a device, silent and at zero, for blocks of `block_frames`; returns its handle, greater
/// than zero. `[any thread; may wait]`
pub type OpenFn = unsafe extern "C" fn(
    settings: *const u8,
    settings_len: usize,
    rate_hz: f64,
    block_frames: u32,
) -> i64;
/// Takes samples, as many as fit within `timeout_ms` (0: those that fit now); returns
/// their number. The first start the device. `[one thread at a time for one device; may wait]`
pub type WriteFn =
    unsafe extern "C" fn(device: i64, samples: *const f32, frames: usize, timeout_ms: u32) -> i64;
/// Writes the numbers at `STATUS_…`, no more than `capacity`; returns how many there are.
/// `[one thread at a time for one device]`
pub type StatusFn = unsafe extern "C" fn(device: i64, out: *mut f64, capacity: usize) -> i64;
/// Plays what was written to its end, goes to zero and keeps the result; returns 0.
/// `[one thread at a time for one device; may wait]`
pub type FinishFn = extern "C" fn(device: i64) -> i64;
/// Closes a device; without [`FinishFn`] before, it aborts: the output goes to zero at once, and a
/// file that was being written is not left behind. Returns 0.
/// `[one thread at a time for one device]`
pub type CloseFn = extern "C" fn(device: i64) -> i64;
/// Returns 1 if the extension named by UTF-8 `id` (`htex.NAME/REV`, `com.vendor.NAME/REV`) is
/// present, else 0. `[any thread]`
pub type ExtensionFn = unsafe extern "C" fn(id: *const u8, id_len: usize) -> i64;

/// Everything a native device exports, in one table: filled from symbols of the same names
/// (`htex_device_…`).
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
