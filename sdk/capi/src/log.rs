//! Messages for the user of a program: what was noticed, and is no error of a call.

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

/// Receives a message, UTF-8, valid during the call. `context` is that of htex_set_log.
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

/// [any thread] Sets the function that receives messages; NULL: none, which is the default. It is
/// called in the thread of the call that has the message, which is never one that renders or sets a
/// motion, and must not call back into the library.
///
/// Once this returns the previous function is not called any more.
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

/// Passes messages to nobody any more.
pub(crate) fn forget_log() {
    *LOG.write().unwrap_or_else(PoisonError::into_inner) = None;
}

/// Passes a message on.
pub(crate) fn log(level: htex_log_level, message: &str) {
    let log = LOG.read().unwrap_or_else(PoisonError::into_inner);
    let (Some(log), Ok(message)) = (&*log, CString::new(message.replace('\0', " "))) else {
        return;
    };
    // SAFETY: the caller of `htex_set_log` vouches for its function.
    unsafe { (log.callback)(level, message.as_ptr(), log.context) };
}
