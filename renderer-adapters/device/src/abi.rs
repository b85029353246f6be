//! The frozen device ABI: the constants and function signatures that a host and a native device (an
//! output or an input) share.
//!
//! A library exports one function, [`EntryFn`], which returns its [`DeviceTable`]. The functions
//! take and return only scalars. A buffer is passed as a pointer and a length. A negative result is
//! a [`Code`].
//!
//! A function that returns a text writes as much of the text as fits into the caller's buffer, and
//! returns the length of the whole text in bytes. If the buffer was too small, the caller calls the
//! function again with a larger buffer.
//!
//! The host passes settings as UTF-8 lines `name=value`, each with a line end, in the order in
//! which the descriptor lists them. The host passes every setting, after it has applied the profile
//! and the defaults.
//!
//! Samples of an output are `f32`. Samples of an input are `f64`. Samples of an input are
//! interleaved: a frame consists of one sample of each channel, and the frames follow one another.

/// Major version: a host loads only devices with the same major version as the host.
pub const ABI_MAJOR: u32 = 1;
/// Minor version: increases when functions are added at the end of the table.
pub const ABI_MINOR: u32 = 0;
/// The marker of a table: 0x4844 in the upper 16 bits, then one byte each for the major and the
/// minor version.
pub const ABI_MARKER: u32 = 0x4844_0000 | (ABI_MAJOR << 8) | ABI_MINOR;

/// Maximum length of any text in either direction, bytes.
pub const MAX_TEXT_BYTES: usize = 1_048_576;
/// Maximum number of settings in a descriptor, and maximum number of profiles.
pub const MAX_SETTINGS: usize = 64;
/// Lowest rate of an output, hertz.
pub const MIN_RATE_HZ: f64 = 1.0;
/// Lowest rate of an input, hertz.
pub const MIN_INPUT_RATE_HZ: f64 = 0.001;
/// Highest rate of a device, hertz.
pub const MAX_RATE_HZ: f64 = 10_000_000.0;
/// Maximum block size of an output, frames. This limit applies to the size that the output prefers
/// and to the size with which the host opens the output. The minimum is one.
pub const MAX_BLOCK_FRAMES: u32 = 1_048_576;
/// Maximum number of channels of an input. The minimum is one.
pub const MAX_CHANNELS: usize = 1_024;
/// Maximum length of a channel's name or unit, bytes.
pub const MAX_NAME_BYTES: usize = 256;

/// Index in the status numbers: frames that the output has accepted since it was opened.
pub const STATUS_FRAMES_WRITTEN: usize = 0;
/// Index in the status numbers: frames that have been played.
pub const STATUS_FRAMES_PLAYED: usize = 1;
/// Index in the status numbers: underruns, i.e. how often the output ran out of samples.
pub const STATUS_UNDERRUNS: usize = 2;
/// Index in the status numbers: latency from writing a sample to playing it, seconds.
pub const STATUS_LATENCY_S: usize = 3;
/// Index in the status numbers: largest magnitude of a sample that the output has accepted, in the
/// quantity's unit.
pub const STATUS_PEAK: usize = 4;
/// Number of status numbers. Every output reports all of them.
pub const STATUS_NUMBERS: usize = 5;

/// Result codes of calls; errors are negative. The numbers are frozen, because they are part of the
/// ABI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum Code {
    /// The call succeeded.
    Ok = 0,
    /// A pointer, length or block size is invalid, or a text is not UTF-8.
    InvalidArgument = -1,
    /// A setting is unknown, missing or invalid; the text begins with `NAME: `.
    InvalidSetting = -2,
    /// The device does not run at this rate.
    InvalidRate = -3,
    /// A driver is not installed, or no such device is connected.
    Missing = -4,
    /// The device is in use.
    Busy = -5,
    /// A sample is over the limit or not a number; the output is at zero.
    OverLimit = -6,
    /// The output ran out of samples and is at zero. The error text tells the user how to avoid
    /// this error.
    Underflow = -7,
    /// The call came before `start`, after `finish` or after an error.
    Closed = -8,
    /// A file could not be written or read; the text begins with `PATH: `.
    File = -9,
    /// No such device is open, or it was closed.
    BadHandle = -10,
    /// The device's code panicked; the output is at zero.
    Panicked = -11,
    /// Any other failure; see the last-error text.
    Failed = -12,
    /// Frames of an input were lost because they were read too late. The error text tells the user
    /// how to avoid this error.
    Overrun = -13,
    /// An input has ended (e.g. at the end of a file); there are no more frames.
    End = -14,
}

impl Code {
    /// Converts the result of a call to its code. Unknown negative numbers are `Failed`.
    pub(crate) fn from_answer(answer: i64) -> Self {
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
            -13 => Self::Overrun,
            -14 => Self::End,
            _ => Self::Failed,
        }
    }
}

/// The function that a library exports under the name `htex_device_adapter`. Returns the library's
/// table, which lives as long as the library. `[any thread]`
pub type EntryFn = extern "C" fn() -> *const DeviceTable;
/// Writes the descriptor as UTF-8 JSON to `out[0..capacity]`. Returns the length, which is the same
/// at each call. `[any thread]`
pub type DescriptorJson = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Writes the text of the calling thread's last error. Returns the length of the text.
/// `[any thread]`
pub type LastError = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Writes a JSON array of the devices that are connected now. Returns the length, which may change.
/// `[any thread; may wait]`
pub type EndpointsJson = unsafe extern "C" fn(out: *mut u8, capacity: usize) -> i64;
/// Opens a device and returns its handle, which is greater than 0. A newly opened output is silent
/// and at zero, and expects blocks of `block_frames`. A newly opened input does not sample yet. For
/// an input, `rate_hz` and `block_frames` are 0. `[any thread; may wait]`
pub type OpenFn = unsafe extern "C" fn(
    settings: *const u8,
    settings_len: usize,
    rate_hz: f64,
    block_frames: u32,
) -> i64;
/// Ends the stream; returns 0. An output plays all written samples, goes to zero and keeps its
/// result, such as a file. An input stops sampling for good, even if it has already stopped. `[one
/// thread at a time for one device; may wait]`
pub type FinishFn = extern "C" fn(device: i64) -> i64;
/// Closes a device; returns 0. An output that was not finished with [`FinishFn`] aborts: it goes to
/// zero at once, and an unfinished file is removed. `[one thread at a time for one device]`
pub type CloseFn = extern "C" fn(device: i64) -> i64;
/// Returns 1 if the extension named by UTF-8 `id` (`htex.NAME/REV`, `com.vendor.NAME/REV`) is
/// present, else 0. `[any thread]`
pub type ExtensionFn = unsafe extern "C" fn(id: *const u8, id_len: usize) -> i64;
/// Writes the capabilities of an output with these settings as JSON. Returns the length. Does not
/// open the output. `[any thread; may wait]`
pub type CapabilitiesJson = unsafe extern "C" fn(
    settings: *const u8,
    settings_len: usize,
    out: *mut u8,
    capacity: usize,
) -> i64;
/// Passes samples to an output. The output takes as many samples as it has space for within
/// `timeout_ms`, and returns their number. With a timeout of 0, it takes only as many samples as it
/// has space for now. The first samples start the output. `[one thread at a time for one device;
/// may wait]`
pub type WriteFn =
    unsafe extern "C" fn(device: i64, samples: *const f32, frames: usize, timeout_ms: u32) -> i64;
/// Writes up to `capacity` status numbers of an output to `out`, in the order of the indices
/// `STATUS_…`. Returns how many status numbers the output has. `[one thread at a time for one
/// device]`
pub type StatusFn = unsafe extern "C" fn(device: i64, out: *mut f64, capacity: usize) -> i64;
/// Writes the rate and the channels of an open input as JSON. Returns the length, which is the
/// same at each call. `[one thread at a time for one device]`
pub type StreamJson = unsafe extern "C" fn(device: i64, out: *mut u8, capacity: usize) -> i64;
/// Starts the sampling of an input; returns 0. `[one thread at a time for one device; may wait]`
pub type StartFn = extern "C" fn(device: i64) -> i64;
/// Writes the available frames of an input to `samples[0..len]` and returns their number. Waits up
/// to `timeout_ms` for the first frame. `len` is a multiple of the number of channels.
/// `[one thread at a time for one device; may wait]`
pub type ReadFn =
    unsafe extern "C" fn(device: i64, samples: *mut f64, len: usize, timeout_ms: u32) -> i64;

/// The table of a device's functions. An output may have null for the functions of inputs, and an
/// input may have null for the functions of outputs.
#[derive(Clone, Copy)]
#[repr(C)]
#[allow(missing_docs)] // Each type says what its function does.
pub struct DeviceTable {
    /// [`ABI_MARKER`].
    pub marker: u32,
    /// Size of the table in bytes, which grows with the minor version.
    pub size: u32,
    pub descriptor: Option<DescriptorJson>,
    pub last_error: Option<LastError>,
    pub endpoints: Option<EndpointsJson>,
    pub open: Option<OpenFn>,
    pub finish: Option<FinishFn>,
    pub close: Option<CloseFn>,
    pub extension: Option<ExtensionFn>,
    /// This function and the next two are only for outputs.
    pub capabilities: Option<CapabilitiesJson>,
    pub write: Option<WriteFn>,
    pub status: Option<StatusFn>,
    /// This function and the next two are only for inputs.
    pub stream: Option<StreamJson>,
    pub start: Option<StartFn>,
    pub read: Option<ReadFn>,
}
