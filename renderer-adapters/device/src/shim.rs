//! Implements the C functions of the ABI by calling the device traits. The functions check their
//! arguments and catch panics.
//!
//! The code that [`export_device!`](crate::export_device) generates uses this module. Do not use it
//! directly.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::time::Duration;

use crate::abi::{
    ABI_MARKER, Code, DeviceTable, MAX_BLOCK_FRAMES, MAX_RATE_HZ, MAX_TEXT_BYTES, MIN_RATE_HZ,
    STATUS_NUMBERS,
};
use crate::crossing::outgoing;
use crate::handles::Handles;
use crate::{Adapter, DeviceError, Direction, Input, InputFrames, Output, Settings, StreamFormat};

std::thread_local! {
    static LAST_ERROR: RefCell<String> = const { RefCell::new(String::new()) };
}

/// An adapter whose C functions are exported.
pub trait Export: Adapter + Default + 'static {
    /// Returns the adapter and its open devices.
    fn state() -> &'static State<Self>;
}

/// An exported adapter with its open devices.
pub struct State<A> {
    adapter: OnceLock<A>,
    devices: Handles<OpenDevice>,
}

enum OpenDevice {
    Output(Box<dyn Output>),
    Input(Box<dyn Input>),
}

/// A refused call: a code of the ABI and its text.
struct Refusal(Code, String);

impl From<DeviceError> for Refusal {
    fn from(error: DeviceError) -> Self {
        let (code, text) = outgoing(&error);
        Self(code, text)
    }
}

type Answer = Result<i64, Refusal>;

impl<A: Export> Default for State<A> {
    fn default() -> Self {
        Self::new()
    }
}

impl<A: Export> State<A> {
    /// The first use of this state creates the adapter. The first call creates the adapter.
    pub const fn new() -> Self {
        Self { adapter: OnceLock::new(), devices: Handles::new() }
    }

    fn adapter(&self) -> &A {
        self.adapter.get_or_init(A::default)
    }

    /// Parses the settings in lines from the host.
    fn settings(&self, lines: &[u8]) -> Result<Settings, Refusal> {
        if lines.len() > MAX_TEXT_BYTES {
            return Err(argument(format!("settings have at most {MAX_TEXT_BYTES} bytes")));
        }
        let lines = std::str::from_utf8(lines).map_err(|e| argument(format!("settings: {e}")))?;
        Ok(Settings::from_lines(self.adapter().descriptor(), lines)?)
    }

    fn open(&self, lines: &[u8], rate_hz: f64, block_frames: u32) -> Answer {
        let settings = self.settings(lines)?;
        let adapter = self.adapter();
        let device = match adapter.descriptor().direction {
            Direction::Input => OpenDevice::Input(adapter.open_input(&settings)?),
            Direction::Output => {
                if !(MIN_RATE_HZ..=MAX_RATE_HZ).contains(&rate_hz) {
                    let range = format!("{MIN_RATE_HZ} to {MAX_RATE_HZ} Hz");
                    let text = format!("a rate of {rate_hz} Hz; {range} is allowed");
                    return Err(Refusal(Code::InvalidRate, text));
                }
                if !(1..=MAX_BLOCK_FRAMES).contains(&block_frames) {
                    let range = format!("1 to {MAX_BLOCK_FRAMES} are allowed");
                    return Err(argument(format!("blocks of {block_frames}; {range}")));
                }
                let format = StreamFormat { rate_hz, block_frames };
                OpenDevice::Output(adapter.open_output(&settings, &format)?)
            }
        };
        Ok(self.devices.insert(device))
    }

    fn close(&self, device: i64) -> Answer {
        self.devices.remove(device).map(|_| 0).ok_or_else(bad_handle)
    }

    /// Calls a function with the device behind a handle.
    fn with<R>(
        &self,
        device: i64,
        call: impl FnOnce(&mut OpenDevice) -> Result<R, Refusal>,
    ) -> Result<R, Refusal> {
        self.devices.with(device, call).ok_or_else(bad_handle)?
    }

    fn with_output<R>(
        &self,
        device: i64,
        call: impl FnOnce(&mut dyn Output) -> Result<R, DeviceError>,
    ) -> Result<R, Refusal> {
        self.with(device, |device| match device {
            OpenDevice::Output(output) => Ok(call(output.as_mut())?),
            OpenDevice::Input(_) => Err(argument("the device is an input".to_owned())),
        })
    }

    fn with_input<R>(
        &self,
        device: i64,
        call: impl FnOnce(&mut dyn Input) -> Result<R, Refusal>,
    ) -> Result<R, Refusal> {
        self.with(device, |device| match device {
            OpenDevice::Input(input) => call(input.as_mut()),
            OpenDevice::Output(_) => Err(argument("the device is an output".to_owned())),
        })
    }
}

/// Returns the table of an adapter's C functions.
pub const fn table<A: Export>() -> DeviceTable {
    DeviceTable {
        marker: ABI_MARKER,
        size: size_of::<DeviceTable>() as u32,
        descriptor: Some(descriptor::<A>),
        last_error: Some(last_error),
        endpoints: Some(endpoints::<A>),
        open: Some(open::<A>),
        finish: Some(finish::<A>),
        close: Some(close::<A>),
        extension: Some(extension),
        capabilities: Some(capabilities::<A>),
        write: Some(write::<A>),
        status: Some(status::<A>),
        stream: Some(stream::<A>),
        start: Some(start::<A>),
        read: Some(read::<A>),
    }
}

// The functions of the table. `crate::abi` documents each one. By the ABI, their pointers and
// lengths describe arrays of the caller. Therefore, calling `array` and `buffer` is sound.

unsafe extern "C" fn descriptor<A: Export>(out: *mut u8, capacity: usize) -> i64 {
    // SAFETY: the caller's buffer.
    answer(|| copy_json(A::state().adapter().descriptor(), unsafe { buffer(out, capacity) }?))
}

unsafe extern "C" fn last_error(out: *mut u8, capacity: usize) -> i64 {
    let text = LAST_ERROR.with(|last| last.try_borrow().map(|t| t.clone()).unwrap_or_default());
    // SAFETY: the caller's buffer. This call does not use `answer`, because `answer` would replace
    // the text.
    let copied = unsafe { buffer(out, capacity) }.map(|out| copy_text(&text, out));
    copied.unwrap_or_else(|Refusal(code, _)| code as i64)
}

unsafe extern "C" fn endpoints<A: Export>(out: *mut u8, capacity: usize) -> i64 {
    // SAFETY: the caller's buffer.
    answer(|| copy_json(&A::state().adapter().endpoints()?, unsafe { buffer(out, capacity) }?))
}

unsafe extern "C" fn open<A: Export>(
    settings: *const u8,
    settings_len: usize,
    rate_hz: f64,
    block_frames: u32,
) -> i64 {
    answer(|| {
        // SAFETY: the caller's array.
        let settings = unsafe { array("settings", settings, settings_len) }?;
        A::state().open(settings, rate_hz, block_frames)
    })
}

extern "C" fn finish<A: Export>(device: i64) -> i64 {
    answer_of::<A>(device, |state| {
        state.with(device, |device| {
            match device {
                OpenDevice::Output(output) => output.finish(),
                OpenDevice::Input(input) => input.finish(),
            }?;
            Ok(0)
        })
    })
}

extern "C" fn close<A: Export>(device: i64) -> i64 {
    // The device is dropped inside `answer`, so that a panic of the drop becomes a code.
    answer(|| A::state().close(device))
}

/// No extension is defined yet.
unsafe extern "C" fn extension(_id: *const u8, _id_len: usize) -> i64 {
    0
}

unsafe extern "C" fn capabilities<A: Export>(
    settings: *const u8,
    settings_len: usize,
    out: *mut u8,
    capacity: usize,
) -> i64 {
    answer(|| {
        // SAFETY: the caller's array.
        let settings =
            A::state().settings(unsafe { array("settings", settings, settings_len) }?)?;
        let capabilities = A::state().adapter().capabilities(&settings)?;
        // SAFETY: the caller's buffer.
        copy_json(&capabilities, unsafe { buffer(out, capacity) }?)
    })
}

unsafe extern "C" fn write<A: Export>(
    device: i64,
    samples: *const f32,
    frames: usize,
    timeout_ms: u32,
) -> i64 {
    answer_of::<A>(device, |state| {
        // SAFETY: the caller's array.
        let samples = unsafe { array("samples", samples, frames) }?;
        let timeout = Duration::from_millis(u64::from(timeout_ms));
        let taken = state.with_output(device, |output| output.write(samples, timeout))?;
        Ok(taken as i64)
    })
}

unsafe extern "C" fn status<A: Export>(device: i64, out: *mut f64, capacity: usize) -> i64 {
    answer(|| {
        // SAFETY: the caller's buffer.
        let out = unsafe { buffer(out, capacity) }?;
        let status = A::state().with_output(device, |output| Ok(output.status()))?;
        let numbers: [f64; STATUS_NUMBERS] = status.into();
        for (to, number) in out.iter_mut().zip(numbers) {
            *to = number;
        }
        Ok(STATUS_NUMBERS as i64)
    })
}

unsafe extern "C" fn stream<A: Export>(device: i64, out: *mut u8, capacity: usize) -> i64 {
    answer(|| {
        // SAFETY: the caller's buffer.
        let out = unsafe { buffer(out, capacity) }?;
        A::state().with_input(device, |input| copy_json(input.stream(), out))
    })
}

extern "C" fn start<A: Export>(device: i64) -> i64 {
    answer_of::<A>(device, |state| {
        state.with_input(device, |input| {
            input.start()?;
            Ok(0)
        })
    })
}

unsafe extern "C" fn read<A: Export>(
    device: i64,
    samples: *mut f64,
    len: usize,
    timeout_ms: u32,
) -> i64 {
    answer_of::<A>(device, |state| {
        // SAFETY: the caller's buffer.
        let samples = unsafe { buffer(samples, len) }?;
        let timeout = Duration::from_millis(u64::from(timeout_ms));
        state.with_input(device, |input| {
            let channels = input.stream().channels.len();
            // `checked_rem` also covers a faulty input without channels.
            if len.checked_rem(channels) != Some(0) {
                return Err(argument(format!("{len} samples of {channels} channels")));
            }
            match input.read(samples, timeout)? {
                InputFrames::Count(frames) => Ok(frames as i64),
                InputFrames::End => Err(Refusal(Code::End, "the input has ended".to_owned())),
            }
        })
    })
}

/// Returns an array of the caller. Refuses a null or misaligned pointer if the length is above 0.
///
/// # Safety
/// `pointer` is null, or `len` values can be read there for `'a`.
unsafe fn array<'a, T>(name: &str, pointer: *const T, len: usize) -> Result<&'a [T], Refusal> {
    // A null pointer is allowed for an empty array, but a slice must not have one.
    if len == 0 {
        return Ok(&[]);
    }
    if pointer.is_null() || !pointer.is_aligned() || !fits::<T>(len) {
        return Err(argument(format!("`{name}` is not a usable array")));
    }
    // SAFETY: not null, aligned, not longer than memory; readable by the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts(pointer, len) })
}

/// Returns a buffer of the caller. Refuses a null or misaligned pointer if the length is above 0.
///
/// # Safety
/// `pointer` is null, or `len` initialised values can be written there for `'a`, only by us.
unsafe fn buffer<'a, T>(pointer: *mut T, len: usize) -> Result<&'a mut [T], Refusal> {
    // The same holds as for an array: a slice must not have a null pointer.
    if len == 0 {
        return Ok(&mut []);
    }
    if pointer.is_null() || !pointer.is_aligned() || !fits::<T>(len) {
        return Err(argument("the buffer is not usable".to_owned()));
    }
    // SAFETY: not null, aligned, not longer than memory; ours by the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, len) })
}

/// Whether an array of `len` values fits in memory at all.
fn fits<T>(len: usize) -> bool {
    len <= isize::MAX as usize / size_of::<T>().max(1)
}

fn argument(text: String) -> Refusal {
    Refusal(Code::InvalidArgument, text)
}

fn bad_handle() -> Refusal {
    let text = "no such device is open; it may have been closed";
    Refusal(Code::BadHandle, text.to_owned())
}

/// Runs a call. An error or a panic becomes a code, and its text becomes the last error.
fn answer(call: impl FnOnce() -> Answer) -> i64 {
    // A panic must not leave the library.
    let result = catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| {
        // The payload is one of these two types, depending on whether the message was formatted.
        let text = panic
            .downcast_ref::<&str>()
            .map(ToString::to_string)
            .or_else(|| panic.downcast_ref::<String>().cloned())
            .unwrap_or_default();
        Err(Refusal(Code::Panicked, format!("the device panicked: {text}")))
    });
    result.unwrap_or_else(|Refusal(code, text)| {
        LAST_ERROR.with(|last| {
            if let Ok(mut last) = last.try_borrow_mut() {
                *last = text;
            }
        });
        code as i64
    })
}

/// Runs a call as [`answer`] does. After a panic, the device behind the handle is dropped, so that
/// its output goes to zero.
fn answer_of<A: Export>(device: i64, call: impl FnOnce(&State<A>) -> Answer) -> i64 {
    let answered = answer(|| call(A::state()));
    if answered == Code::Panicked as i64 {
        // A second panic, in the drop, is ignored: the first one is already reported.
        let _ = catch_unwind(AssertUnwindSafe(|| drop(A::state().close(device))));
    }
    answered
}

fn copy_json(value: &impl serde::Serialize, out: &mut [u8]) -> Answer {
    let json = serde_json::to_string(value)
        .map_err(|error| Refusal(Code::Failed, format!("cannot write JSON: {error}")))?;
    Ok(copy_text(&json, out))
}

fn copy_text(text: &str, out: &mut [u8]) -> i64 {
    let n = text.len().min(out.len());
    out[..n].copy_from_slice(&text.as_bytes()[..n]);
    text.len() as i64
}
