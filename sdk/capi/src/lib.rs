//! libhtex: the player, the libraries and the scenes of [`htex`] as C functions. `include/htex.h`
//! is generated from this crate.
//!
//! - Objects are handles, one number each. A freed handle, a number that is not a handle, or an
//!   object that another thread is using is an error, not undefined behaviour (`handles`).
//! - A call returns a [`htex_status`]. The text of a thread's last error is [`htex_last_error`]. No
//!   call unwinds.
//! - A struct of options begins with its size in bytes. Zero in the other fields selects the
//!   defaults, so programs that were compiled against an older header still run.
#![warn(missing_docs)]
#![allow(non_camel_case_types)] // The names of the C header.
#![allow(clippy::missing_safety_doc)] // Stated once: see `pointers`.

mod asset;
#[cfg(target_family = "wasm")]
// Pages call these functions by their exported names.
#[allow(unreachable_pub)]
mod browser;
mod device;
mod handles;
mod library;
mod log;
mod memory;
mod motion;
mod options;
mod pointers;
mod reader;
mod scene;
mod shutdown;
mod status;
mod voice;

/// Building blocks of the functions in this crate, for the functions that the module in
/// `sdk/web/author` adds. Not part of the C interface.
#[doc(hidden)]
pub mod calls {
    pub use crate::memory::{allocate, free};
    pub use crate::pointers::{needed_text, place, slice};
    pub use crate::status::{Failure, guarded};
}

pub use asset::*;
#[cfg(target_family = "wasm")]
pub use browser::{htex_alloc, htex_free};
pub use device::*;
pub use library::*;
pub use log::{htex_log_callback, htex_log_level, htex_set_log};
pub use motion::htex_motion;
pub use options::*;
pub use reader::{htex_files, htex_reader};
pub use scene::*;
pub use shutdown::htex_shutdown;
pub use status::{htex_last_error, htex_status, htex_status_text};
pub use voice::*;

/// Version of this interface, major and minor: 0x00010000 is 1.0. A new minor version only adds to
/// it.
pub const HTEX_API_VERSION: u32 = 0x0001_0000;

/// [any thread] Returns the interface version of the loaded library, in the form of
/// HTEX_API_VERSION.
#[unsafe(no_mangle)]
pub extern "C" fn htex_api_version() -> u32 {
    HTEX_API_VERSION
}

/// [any thread] Returns the version of the library, such as "0.2.0". The text is static.
#[unsafe(no_mangle)]
pub extern "C" fn htex_version() -> *const std::ffi::c_char {
    const TEXT: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    TEXT.as_ptr().cast()
}
