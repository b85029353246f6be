//! Status codes of calls, and the text of a thread's last error.

use std::cell::UnsafeCell;
use std::ffi::{CStr, c_char};
use std::fmt::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Status of a call. All values except HTEX_STATUS_OK are errors. Later versions may add values.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum htex_status {
    /// The call succeeded.
    HTEX_STATUS_OK = 0,
    /// A pointer is NULL or misaligned, a text is not UTF-8, or a number is out of range.
    HTEX_STATUS_INVALID_ARGUMENT = 1,
    /// The handle was freed, or it was never a handle of this kind of object.
    HTEX_STATUS_BAD_HANDLE = 2,
    /// Another thread is using the object.
    HTEX_STATUS_BUSY = 3,
    /// A file could not be read.
    HTEX_STATUS_IO = 4,
    /// The asset is invalid.
    HTEX_STATUS_INVALID_ASSET = 5,
    /// The asset has no such representation.
    HTEX_STATUS_NO_REPRESENTATION = 6,
    /// A model is missing, incompatible or not allowed to run.
    HTEX_STATUS_NO_MODEL = 7,
    /// A model failed.
    HTEX_STATUS_MODEL = 8,
    /// A speed, force or position is invalid.
    HTEX_STATUS_INVALID_MOTION = 9,
    /// The scene is invalid, or cannot be planned.
    HTEX_STATUS_INVALID_SCENE = 10,
    /// This build of the library lacks the feature.
    HTEX_STATUS_UNSUPPORTED = 11,
    /// The buffer is too small for the text. The buffer contains the beginning of the text.
    HTEX_STATUS_TRUNCATED = 12,
    /// An error in the library itself. Free the object that was passed to the call.
    HTEX_STATUS_INTERNAL = 13,
    /// The texture library is invalid.
    HTEX_STATUS_INVALID_LIBRARY = 14,
    /// The library has no texture with this name.
    HTEX_STATUS_ABSENT = 15,
    /// The device or its driver is missing, is in use, or failed. The device is then at rest.
    HTEX_STATUS_DEVICE = 16,
    /// The file is not signed by any of the keys in `only_signed_by` of htex_open_options.
    HTEX_STATUS_NOT_SIGNED = 17,
}

/// The error of a call: a status and a text.
#[derive(Debug)]
pub struct Failure {
    status: htex_status,
    text: Text,
}

#[derive(Debug)]
enum Text {
    Plain(&'static str),
    /// This error is not boxed, so that calls in a real-time thread can fail without allocating.
    Playing(htex::Error),
    #[cfg(feature = "scene")]
    Scene(htex::scene::SceneError),
    Of(Box<dyn std::error::Error>),
}

impl Failure {
    /// Makes an error with a fixed text; does not allocate.
    pub const fn plain(status: htex_status, text: &'static str) -> Self {
        let text = Text::Plain(text);
        Self { status, text }
    }

    /// Makes an error for an invalid argument; does not allocate.
    pub const fn argument(text: &'static str) -> Self {
        Self::plain(htex_status::HTEX_STATUS_INVALID_ARGUMENT, text)
    }

    /// Makes an error from an error of an `htex` crate, or from a text.
    pub fn new(status: htex_status, error: impl Into<Box<dyn std::error::Error>>) -> Self {
        let text = Text::Of(error.into());
        Self { status, text }
    }
}

#[cfg(feature = "library")]
impl From<htex::library::LibraryError> for Failure {
    fn from(error: htex::library::LibraryError) -> Self {
        use htex::library::LibraryError;
        let status = match &error {
            LibraryError::Open { .. } | LibraryError::Read { .. } => htex_status::HTEX_STATUS_IO,
            LibraryError::Absent { .. } => htex_status::HTEX_STATUS_ABSENT,
            LibraryError::Signature(_) => htex_status::HTEX_STATUS_NOT_SIGNED,
            _ => htex_status::HTEX_STATUS_INVALID_LIBRARY,
        };
        Self::new(status, error)
    }
}

#[cfg(feature = "scene")]
impl From<htex::scene::SceneError> for Failure {
    fn from(error: htex::scene::SceneError) -> Self {
        use htex::scene::SceneErrorKind;
        use htex_status::*;
        let status = match error.kind() {
            SceneErrorKind::Io => HTEX_STATUS_IO,
            SceneErrorKind::Motion => HTEX_STATUS_INVALID_MOTION,
            SceneErrorKind::Model => HTEX_STATUS_MODEL,
            SceneErrorKind::NoModel => HTEX_STATUS_NO_MODEL,
            SceneErrorKind::Signature => HTEX_STATUS_NOT_SIGNED,
            _ => HTEX_STATUS_INVALID_SCENE,
        };
        let text = Text::Scene(error);
        Self { status, text }
    }
}

impl From<htex::Error> for Failure {
    fn from(error: htex::Error) -> Self {
        use htex::play::ErrorKind;
        use htex_status::*;
        let status = match error.kind() {
            ErrorKind::Io => HTEX_STATUS_IO,
            ErrorKind::InvalidAsset => HTEX_STATUS_INVALID_ASSET,
            ErrorKind::Library => HTEX_STATUS_INVALID_LIBRARY,
            ErrorKind::Signature => HTEX_STATUS_NOT_SIGNED,
            ErrorKind::NoRepresentation => HTEX_STATUS_NO_REPRESENTATION,
            ErrorKind::Model => HTEX_STATUS_MODEL,
            ErrorKind::Motion => HTEX_STATUS_INVALID_MOTION,
            ErrorKind::Option => HTEX_STATUS_INVALID_ARGUMENT,
            _ => HTEX_STATUS_NO_MODEL,
        };
        let text = Text::Playing(error);
        Self { status, text }
    }
}

/// Room for the text of the last error, bytes, including a terminating zero.
const TEXT_BYTES: usize = 1024;

/// The text of a thread's last error. Each thread has its own memory for it, so that setting it
/// does not allocate.
#[repr(C)] // `bytes` comes first: `htex_last_error` returns its address.
struct LastError {
    bytes: [u8; TEXT_BYTES],
    len: usize,
}

thread_local! {
    static LAST: UnsafeCell<LastError> = const {
        UnsafeCell::new(LastError { bytes: [0; TEXT_BYTES], len: 0 })
    };
}

impl Write for LastError {
    /// Appends as many whole characters as fit.
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let space = TEXT_BYTES - 1 - self.len;
        let len = text.floor_char_boundary(space);
        self.bytes[self.len..self.len + len].copy_from_slice(&text.as_bytes()[..len]);
        self.len += len;
        self.bytes[self.len] = 0;
        if len < text.len() { Err(fmt::Error) } else { Ok(()) }
    }
}

fn remember(text: &Text) {
    LAST.with(|last| {
        // SAFETY: only this thread has access, and nothing that `write!` calls accesses this value
        // again.
        let last = unsafe { &mut *last.get() };
        last.len = 0;
        // An error only means that the text was cut off.
        let _ = match text {
            Text::Plain(text) => last.write_str(text),
            Text::Playing(error) => write!(last, "{error}"),
            #[cfg(feature = "scene")]
            Text::Scene(error) => write!(last, "{error}"),
            Text::Of(error) => write!(last, "{error}"),
        };
    });
}

/// [any thread] Returns the text of the calling thread's last error, in English; empty if there was
/// no error. The text is UTF-8, and at most 1023 bytes long. The text is valid until the thread's
/// next call that fails. A successful call does not change the text.
#[unsafe(no_mangle)]
pub extern "C" fn htex_last_error() -> *const c_char {
    LAST.with(|last| last.get().cast::<c_char>().cast_const())
}

/// [any thread; real-time] Returns the meaning of a status, in English, or "unknown status" for an
/// unknown number. The text stays valid and must not be freed.
#[unsafe(no_mangle)]
pub extern "C" fn htex_status_text(status: i32) -> *const c_char {
    let text: &CStr = match status {
        0 => c"the call succeeded",
        1 => c"an argument is invalid",
        2 => c"there is no such object",
        3 => c"another thread uses the object",
        4 => c"a file could not be read",
        5 => c"the asset is invalid",
        6 => c"the asset has no such representation",
        7 => c"a model is missing, incompatible or not allowed to run",
        8 => c"a model failed",
        9 => c"the motion is invalid",
        10 => c"the scene is invalid or cannot be planned",
        11 => c"this build of the library lacks the feature",
        12 => c"the buffer is too small",
        13 => c"an error of the library itself",
        14 => c"the library of textures is invalid",
        15 => c"the library has no texture of this name",
        16 => c"the device or its driver is missing, in use, or failed",
        17 => c"the file is not signed by an accepted key",
        _ => c"unknown status",
    };
    text.as_ptr()
}

/// Runs the body of a C function. Stores the text of an error, and turns panics into errors.
pub fn guarded(body: impl FnOnce() -> Result<(), Failure>) -> htex_status {
    // The header tells programs to free the object after this error, so its state does not matter.
    let result = catch_unwind(AssertUnwindSafe(body)).unwrap_or(Err(Failure::plain(
        htex_status::HTEX_STATUS_INTERNAL,
        "an error of the library itself; please report it",
    )));
    match result {
        Ok(()) => htex_status::HTEX_STATUS_OK,
        Err(failure) => {
            remember(&failure.text);
            failure.status
        }
    }
}
