//! Functions with which JavaScript (`sdk/bindings/web/src/core.js`) allocates memory in the WASM
//! module for the arguments and results of calls. They are not part of the C interface.

#[cfg(feature = "library")]
mod library;
mod texture;

use crate::memory::{allocate, free};

/// Allocates bytes, aligned to 8; NULL if there is no memory.
#[unsafe(no_mangle)]
pub extern "C" fn htex_alloc(bytes: usize) -> *mut u8 {
    allocate(bytes)
}

/// Frees memory from [`htex_alloc`]. `bytes` must be the number of bytes that was allocated.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_free(at: *mut u8, bytes: usize) {
    // SAFETY: the caller says so.
    unsafe { free(at, bytes) };
}
