//! Memory that crosses the interface to JavaScript: allocated on one side, freed on the other.

use std::alloc::{Layout, alloc, dealloc};

/// Alignment of all that is allocated.
const ALIGNMENT: usize = 8;

fn layout(bytes: usize) -> Option<Layout> {
    let size = bytes.max(1);
    Layout::from_size_align(size, ALIGNMENT).ok()
}

/// Allocates bytes, at a multiple of 8; NULL if there are none.
pub fn allocate(bytes: usize) -> *mut u8 {
    // SAFETY: the size is not zero.
    layout(bytes).map_or(std::ptr::null_mut(), |layout| unsafe { alloc(layout) })
}

/// Frees bytes that [`allocate`] returned for the same number.
///
/// # Safety
/// The caller says so; NULL is no memory.
pub unsafe fn free(at: *mut u8, bytes: usize) {
    if let Some(layout) = layout(bytes).filter(|_| !at.is_null()) {
        // SAFETY: as here.
        unsafe { dealloc(at, layout) };
    }
}
