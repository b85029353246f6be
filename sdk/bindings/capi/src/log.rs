//! Messages for the user of a program, about observations that do not make a call fail.

use std::ffi::{CString, c_char, c_void};
use std::sync::{PoisonError, RwLock};

use crate::status::{Failure, guarded, htex_status};

/// Level of a message.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum htex_log_level {
    /// Information that needs no action.
    HTEX_LOG_INFO = 0,
    /// Something that the user should know.
    HTEX_LOG_WARNING = 1,
}

/// A function of the program that receives messages. `message` is UTF-8 and is valid only during
/// the call. `context` is the value that was passed to htex_set_log.
pub type htex_log_callback = Option<
    unsafe extern "C" fn(level: htex_log_level, message: *const c_char, context: *mut c_void),
>;

struct Log {
    callback: unsafe extern "C" fn(htex_log_level, *const c_char, *mut c_void),
    context: *mut c_void,
}

// SAFETY: the caller of `htex_set_log` allows calls from any thread.
unsafe impl Send for Log {}
// SAFETY: as above.
unsafe impl Sync for Log {}

static LOG: RwLock<Option<Log>> = RwLock::new(None);

/// [any thread] Sets the function that receives messages. NULL, the default, discards all messages.
/// The library calls the function in the thread of the call that causes the message. Calls that
/// render or set a motion never cause messages. The function must not call the library.
///
/// After htex_set_log returns, the library does not call the previous function any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_set_log(
    callback: htex_log_callback,
    context: *mut c_void,
) -> htex_status {
    guarded(|| {
        let log = callback.map(|callback| Log { callback, context });
        *LOG.write().unwrap_or_else(PoisonError::into_inner) = log;
        Ok::<_, Failure>(())
    })
}

/// Removes the function that receives messages.
pub(crate) fn forget_log() {
    *LOG.write().unwrap_or_else(PoisonError::into_inner) = None;
}

/// Passes a message to the function that receives messages, if there is one.
pub(crate) fn log(level: htex_log_level, message: &str) {
    // The lock is held during the call, so that `htex_set_log` waits for the end of the call.
    let log = LOG.read().unwrap_or_else(PoisonError::into_inner);
    // A message may quote a text that contains a zero byte, where C would end the message.
    let (Some(log), Ok(message)) = (&*log, CString::new(message.replace('\0', " "))) else {
        return;
    };
    // SAFETY: the caller of `htex_set_log` vouches for its function.
    unsafe { (log.callback)(level, message.as_ptr(), log.context) };
}
