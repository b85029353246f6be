//! The common part of the device and source shims: arrays from the host, answers, texts.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;

use crate::abi::{Code, MAX_TEXT_BYTES};
use crate::crossing::outgoing;
use crate::handles::Handles;
use crate::{Descriptor, DeviceError, Settings};

std::thread_local! {
    static LAST_ERROR: RefCell<String> = const { RefCell::new(String::new()) };
}

/// An input array from the host: a pointer and a length.
pub struct Input<'a, T>(Option<&'a [T]>);

impl<'a, T> Input<'a, T> {
    /// Refuses a null or misaligned pointer if the length is above 0.
    ///
    /// # Safety
    /// `pointer` is null, or `len` values can be read there for `'a`.
    pub unsafe fn new(pointer: *const T, len: usize) -> Self {
        // A null pointer is allowed for an empty array, but a slice must not have one.
        if len == 0 {
            return Self(Some(&[]));
        }
        let usable = !pointer.is_null() && pointer.is_aligned() && fits::<T>(len);
        // SAFETY: not null, aligned, not longer than memory; readable by the caller's promise.
        Self(usable.then(|| unsafe { std::slice::from_raw_parts(pointer, len) }))
    }

    pub(crate) fn get(self, name: &str) -> Result<&'a [T], Refusal> {
        self.0.ok_or_else(|| argument(format!("`{name}` is not a usable array")))
    }
}

/// An output buffer from the host: a pointer and a length.
pub struct Output<'a, T>(Option<&'a mut [T]>);

impl<'a, T> Output<'a, T> {
    /// Refuses a null or misaligned pointer if the length is above 0.
    ///
    /// # Safety
    /// `pointer` is null, or `len` initialised values can be written there for `'a`, only by us.
    pub unsafe fn new(pointer: *mut T, len: usize) -> Self {
        // As for an input: a slice must not have a null pointer.
        if len == 0 {
            return Self(Some(&mut []));
        }
        let usable = !pointer.is_null() && pointer.is_aligned() && fits::<T>(len);
        // SAFETY: not null, aligned, not longer than memory; ours by the caller's promise.
        Self(usable.then(|| unsafe { std::slice::from_raw_parts_mut(pointer, len) }))
    }

    pub(crate) fn get(self, name: &str) -> Result<&'a mut [T], Refusal> {
        self.0.ok_or_else(|| argument(format!("`{name}` is not a usable buffer")))
    }
}

/// Whether an array of `len` values fits in memory at all.
fn fits<T>(len: usize) -> bool {
    len <= isize::MAX as usize / size_of::<T>().max(1)
}

/// A refused call: a code of the ABI and its text.
pub(crate) struct Refusal(pub(crate) i64, pub(crate) String);

impl From<DeviceError> for Refusal {
    fn from(error: DeviceError) -> Self {
        let (code, text) = outgoing(&error);
        Self(code as i64, text)
    }
}

pub(crate) fn argument(text: String) -> Refusal {
    Refusal(Code::InvalidArgument as i64, text)
}

/// Parses the settings in lines from the host.
pub(crate) fn settings(descriptor: &Descriptor, lines: Input<'_, u8>) -> Result<Settings, Refusal> {
    let lines = lines.get("settings")?;
    if lines.len() > MAX_TEXT_BYTES {
        return Err(argument(format!("settings have at most {MAX_TEXT_BYTES} bytes")));
    }
    let lines = std::str::from_utf8(lines).map_err(|e| argument(format!("settings: {e}")))?;
    Ok(Settings::from_lines(descriptor, lines)?)
}

/// See [`crate::abi::LastError`].
pub fn last_error(out: Output<'_, u8>) -> i64 {
    let text = LAST_ERROR.with(|last| last.try_borrow().map(|t| t.clone()).unwrap_or_default());
    out.0.map_or(Code::InvalidArgument as i64, |out| copy_text(&text, out))
}

/// See [`crate::abi::ExtensionFn`]. No extension is defined yet.
pub fn extension(_id: Input<'_, u8>) -> i64 {
    0
}

/// An exported adapter with its open devices or sources. `kind` is `device` or `source`.
pub(crate) struct Exported<A, T: ?Sized> {
    kind: &'static str,
    adapter: OnceLock<A>,
    open: Handles<T>,
}

impl<A: Default, T: ?Sized> Exported<A, T> {
    /// Creates the state without an adapter and with nothing open.
    pub(crate) const fn new(kind: &'static str) -> Self {
        Self { kind, adapter: OnceLock::new(), open: Handles::new() }
    }

    pub(crate) fn adapter(&self) -> &A {
        self.adapter.get_or_init(A::default)
    }

    /// Stores an open device or source and returns its handle.
    pub(crate) fn insert(&self, opened: Box<T>) -> i64 {
        self.open.insert(opened)
    }

    /// Calls a function with the device or source behind a handle.
    pub(crate) fn with<R>(
        &self,
        handle: i64,
        call: impl FnOnce(&mut T) -> Result<R, Refusal>,
    ) -> Result<R, Refusal> {
        let called = self.open.with(handle, call);
        called.ok_or_else(|| self.bad_handle())?
    }

    /// Runs a call. An error or a panic becomes a code, and its text becomes the last error.
    pub(crate) fn answer(&self, call: impl FnOnce() -> Result<i64, Refusal>) -> i64 {
        answer(self.kind, call)
    }

    /// Runs a call as [`Self::answer`] does. After a panic, the device or source behind the handle
    /// is dropped, so that its output goes to zero.
    pub(crate) fn answer_of(
        &self,
        handle: i64,
        call: impl FnOnce() -> Result<i64, Refusal>,
    ) -> i64 {
        let answered = self.answer(call);
        if answered == Code::Panicked as i64 {
            // A second panic, in the drop, is ignored: the first one is already reported.
            let _ = catch_unwind(AssertUnwindSafe(|| drop(self.open.remove(handle))));
        }
        answered
    }

    pub(crate) fn close(&self, handle: i64) -> i64 {
        self.answer(|| {
            // The drop runs inside `answer`, so that a panic in it becomes a code.
            let closed = self.open.remove(handle).map(|_| 0);
            closed.ok_or_else(|| self.bad_handle())
        })
    }

    fn bad_handle(&self) -> Refusal {
        let kind = self.kind;
        let text = format!("no such {kind} is open; it may have been closed");
        Refusal(Code::BadHandle as i64, text)
    }
}

/// Runs a call of a device or source (`kind`). An error or a panic becomes a code, and its text
/// becomes the last error.
fn answer(kind: &str, call: impl FnOnce() -> Result<i64, Refusal>) -> i64 {
    // A panic must not leave the library.
    let result = catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| {
        // The payload is one of these two types, depending on whether the message was formatted.
        let text = panic
            .downcast_ref::<&str>()
            .map(ToString::to_string)
            .or_else(|| panic.downcast_ref::<String>().cloned())
            .unwrap_or_default();
        Err(Refusal(Code::Panicked as i64, format!("the {kind} panicked: {text}")))
    });
    result.unwrap_or_else(|Refusal(code, text)| {
        LAST_ERROR.with(|last| {
            if let Ok(mut last) = last.try_borrow_mut() {
                *last = text;
            }
        });
        code
    })
}

pub(crate) fn copy_json(
    value: &impl serde::Serialize,
    out: Output<'_, u8>,
) -> Result<i64, Refusal> {
    let json = serde_json::to_string(value)
        .map_err(|e| Refusal(Code::Failed as i64, format!("cannot write JSON: {e}")))?;
    Ok(copy_text(&json, out.get("out")?))
}

fn copy_text(text: &str, out: &mut [u8]) -> i64 {
    let n = text.len().min(out.len());
    out[..n].copy_from_slice(&text.as_bytes()[..n]);
    text.len() as i64
}
