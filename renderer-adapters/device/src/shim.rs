//! From the traits to the C functions: checks arguments and catches panics.
//!
//! Called by the functions that [`export_device!`](crate::export_device) makes; not by hand.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::time::Duration;

use crate::abi::{
    Code, MAX_BLOCK_FRAMES, MAX_RATE_HZ, MAX_TEXT_BYTES, MIN_RATE_HZ, STATUS_NUMBERS,
};
use crate::crossing::outgoing;
use crate::handles::Handles;
use crate::{Adapter, Device, DeviceError, Settings, StreamFormat};

std::thread_local! {
    static LAST_ERROR: RefCell<String> = const { RefCell::new(String::new()) };
}

/// The state of an exported adapter: itself and its open devices.
pub struct State<A> {
    adapter: OnceLock<A>,
    devices: Handles,
}

impl<A: Adapter + Default> Default for State<A> {
    fn default() -> Self {
        Self::new()
    }
}

/// A pointer and a length from the other side.
pub struct Input<'a, T>(Option<&'a [T]>);

impl<'a, T> Input<'a, T> {
    /// Refuses null and misaligned pointers when there is something to read.
    ///
    /// # Safety
    /// `pointer` is null, or `len` values can be read there for `'a`.
    pub unsafe fn new(pointer: *const T, len: usize) -> Self {
        if len == 0 {
            return Self(Some(&[]));
        }
        let usable = !pointer.is_null() && pointer.is_aligned() && fits::<T>(len);
        // SAFETY: not null, aligned, not longer than memory; readable by the caller's promise.
        Self(usable.then(|| unsafe { std::slice::from_raw_parts(pointer, len) }))
    }

    fn get(self, name: &str) -> Result<&'a [T], Refusal> {
        self.0
            .ok_or_else(|| argument(format!("`{name}` is not a usable array")))
    }
}

/// A buffer to write to, from the other side.
pub struct Output<'a, T>(Option<&'a mut [T]>);

impl<'a, T> Output<'a, T> {
    /// Refuses null and misaligned pointers when there is space to write.
    ///
    /// # Safety
    /// `pointer` is null, or `len` initialised values can be written there for `'a`, by us alone.
    pub unsafe fn new(pointer: *mut T, len: usize) -> Self {
        if len == 0 {
            return Self(Some(&mut []));
        }
        let usable = !pointer.is_null() && pointer.is_aligned() && fits::<T>(len);
        // SAFETY: not null, aligned, not longer than memory; ours by the caller's promise.
        Self(usable.then(|| unsafe { std::slice::from_raw_parts_mut(pointer, len) }))
    }

    fn get(self, name: &str) -> Result<&'a mut [T], Refusal> {
        self.0
            .ok_or_else(|| argument(format!("`{name}` is not a usable buffer")))
    }
}

fn fits<T>(len: usize) -> bool {
    len <= isize::MAX as usize / size_of::<T>().max(1)
}

/// A code and its text.
struct Refusal(Code, String);

impl From<DeviceError> for Refusal {
    fn from(error: DeviceError) -> Self {
        let (code, text) = outgoing(&error);
        Self(code, text)
    }
}

fn argument(text: String) -> Refusal {
    Refusal(Code::InvalidArgument, text)
}

impl<A: Adapter + Default> State<A> {
    /// No adapter yet, nothing open.
    pub const fn new() -> Self {
        Self {
            adapter: OnceLock::new(),
            devices: Handles::new(),
        }
    }

    fn adapter(&self) -> &A {
        self.adapter.get_or_init(A::default)
    }

    fn settings(&self, lines: Input<'_, u8>) -> Result<Settings, Refusal> {
        let lines = lines.get("settings")?;
        if lines.len() > MAX_TEXT_BYTES {
            return Err(argument(format!(
                "settings have at most {MAX_TEXT_BYTES} bytes"
            )));
        }
        let lines = std::str::from_utf8(lines).map_err(|e| argument(format!("settings: {e}")))?;
        Ok(Settings::from_lines(self.adapter().descriptor(), lines)?)
    }

    fn with<R>(
        &self,
        handle: i64,
        call: impl FnOnce(&mut dyn Device) -> Result<R, DeviceError>,
    ) -> Result<R, Refusal> {
        Ok(self.devices.with(handle, call).ok_or_else(bad_handle)??)
    }

    /// See [`crate::abi::DescriptorJson`].
    pub fn descriptor(&self, out: Output<'_, u8>) -> i64 {
        answer(|| copy_json(self.adapter().descriptor(), out))
    }

    /// See [`crate::abi::EndpointsJson`].
    pub fn endpoints(&self, out: Output<'_, u8>) -> i64 {
        answer(|| copy_json(&self.adapter().endpoints()?, out))
    }

    /// See [`crate::abi::CapabilitiesJson`].
    pub fn capabilities(&self, settings: Input<'_, u8>, out: Output<'_, u8>) -> i64 {
        answer(|| {
            let settings = self.settings(settings)?;
            copy_json(&self.adapter().capabilities(&settings)?, out)
        })
    }

    /// See [`crate::abi::OpenFn`].
    pub fn open(&self, settings: Input<'_, u8>, rate_hz: f64, block_frames: u32) -> i64 {
        answer(|| {
            let settings = self.settings(settings)?;
            if !(MIN_RATE_HZ..=MAX_RATE_HZ).contains(&rate_hz) {
                let range = format!("{MIN_RATE_HZ} to {MAX_RATE_HZ} Hz");
                let text = format!("a rate of {rate_hz} Hz; {range} is allowed");
                return Err(Refusal(Code::InvalidRate, text));
            }
            if !(1..=MAX_BLOCK_FRAMES).contains(&block_frames) {
                let text = format!("blocks of {block_frames}; 1 to {MAX_BLOCK_FRAMES} are allowed");
                return Err(argument(text));
            }
            let format = StreamFormat {
                rate_hz,
                block_frames,
            };
            let device = self.adapter().open(&settings, &format)?;
            Ok(self.devices.insert(device))
        })
    }

    /// See [`crate::abi::WriteFn`]. A panic closes the device.
    pub fn write(&self, handle: i64, samples: Input<'_, f32>, timeout_ms: u32) -> i64 {
        let answered = answer(|| {
            let samples = samples.get("samples")?;
            let timeout = Duration::from_millis(u64::from(timeout_ms));
            let taken = self.with(handle, |device| device.write(samples, timeout))?;
            Ok(taken as i64)
        });
        self.close_if_panicked(handle, answered)
    }

    /// See [`crate::abi::StatusFn`].
    pub fn status(&self, handle: i64, out: Output<'_, f64>) -> i64 {
        answer(|| {
            let out = out.get("out")?;
            let status = self.with(handle, |device| Ok(device.status()))?;
            let numbers: [f64; STATUS_NUMBERS] = status.into();
            for (to, number) in out.iter_mut().zip(numbers) {
                *to = number;
            }
            Ok(STATUS_NUMBERS as i64)
        })
    }

    /// See [`crate::abi::FinishFn`]. A panic closes the device.
    pub fn finish(&self, handle: i64) -> i64 {
        let answered = answer(|| self.with(handle, |device| device.finish()).map(|()| 0));
        self.close_if_panicked(handle, answered)
    }

    /// See [`crate::abi::CloseFn`].
    pub fn close(&self, handle: i64) -> i64 {
        answer(|| {
            self.devices
                .remove(handle)
                .map(|_| 0)
                .ok_or_else(bad_handle)
        })
    }

    /// Drops the device, which sets its output to zero, and returns the result with its text.
    fn close_if_panicked(&self, handle: i64, answered: i64) -> i64 {
        if answered == Code::Panicked as i64 {
            // A second panic, in the drop, adds nothing.
            let _ = catch_unwind(AssertUnwindSafe(|| drop(self.devices.remove(handle))));
        }
        answered
    }
}

/// See [`crate::abi::LastError`].
pub fn last_error(out: Output<'_, u8>) -> i64 {
    let text = LAST_ERROR.with(|last| last.try_borrow().map(|t| t.clone()).unwrap_or_default());
    out.0
        .map_or(Code::InvalidArgument as i64, |out| copy_text(&text, out))
}

/// See [`crate::abi::ExtensionFn`]. No extension is defined yet.
pub fn extension(_id: Input<'_, u8>) -> i64 {
    0
}

/// Runs a call; an error or a panic becomes a code and the last-error text.
fn answer(call: impl FnOnce() -> Result<i64, Refusal>) -> i64 {
    let result = catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| {
        let text = panic
            .downcast_ref::<&str>()
            .map(ToString::to_string)
            .or_else(|| panic.downcast_ref::<String>().cloned())
            .unwrap_or_default();
        Err(Refusal(
            Code::Panicked,
            format!("the device panicked: {text}"),
        ))
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

fn bad_handle() -> Refusal {
    let text = "no such device is open; it may have been closed";
    Refusal(Code::BadHandle, text.to_owned())
}

fn copy_json(value: &impl serde::Serialize, out: Output<'_, u8>) -> Result<i64, Refusal> {
    let json = serde_json::to_string(value)
        .map_err(|e| Refusal(Code::Failed, format!("cannot write JSON: {e}")))?;
    Ok(copy_text(&json, out.get("out")?))
}

fn copy_text(text: &str, out: &mut [u8]) -> i64 {
    let n = text.len().min(out.len());
    out[..n].copy_from_slice(&text.as_bytes()[..n]);
    text.len() as i64
}
