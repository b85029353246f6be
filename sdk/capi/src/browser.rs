//! Memory for the arguments and results of JavaScript (`sdk/web/src/core.js`), which has no other
//! way to get any. Not part of the C interface.

#[cfg(feature = "library")]
mod library;
mod texture;

use crate::memory::{allocate, free};

/// Allocates bytes, at a multiple of 8; NULL if there are none.
#[unsafe(no_mangle)]
pub extern "C" fn htex_alloc(bytes: usize) -> *mut u8 {
    allocate(bytes)
}

/// Frees bytes that [`htex_alloc`] returned for the same number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_free(at: *mut u8, bytes: usize) {
    // SAFETY: the caller says so.
    unsafe { free(at, bytes) };
}
