//! Memory for the arguments and results of JavaScript (`sdk/web/src/core.js`), which has no other way to get any. Not
//! part of the C interface.

#[cfg(feature = "library")]
mod library;
mod texture;

use std::alloc::{Layout, alloc, dealloc};

/// Alignment of all that is allocated.
const ALIGNMENT: usize = 8;

fn layout(bytes: usize) -> Option<Layout> {
    let size = bytes.max(1);
    Layout::from_size_align(size, ALIGNMENT).ok()
}

/// Allocates bytes, at a multiple of 8; NULL if there are none.
#[unsafe(no_mangle)]
pub extern "C" fn htex_alloc(bytes: usize) -> *mut u8 {
    // SAFETY: the size is not zero.
    layout(bytes).map_or(std::ptr::null_mut(), |layout| unsafe { alloc(layout) })
}

/// Frees bytes that [`htex_alloc`] returned for the same number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_free(at: *mut u8, bytes: usize) {
    if let Some(layout) = layout(bytes).filter(|_| !at.is_null()) {
        // SAFETY: the caller says so.
        unsafe { dealloc(at, layout) };
    }
}
