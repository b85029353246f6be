//! Memory that crosses the interface to JavaScript: allocated on one side, freed on the other.

use std::alloc::{Layout, alloc, dealloc};

/// Alignment of all allocations.
const ALIGNMENT: usize = 8;

fn layout(bytes: usize) -> Option<Layout> {
    // `alloc` must not get a size of 0.
    let size = bytes.max(1);
    Layout::from_size_align(size, ALIGNMENT).ok()
}

/// Allocates bytes, aligned to 8; NULL if there is no memory.
pub fn allocate(bytes: usize) -> *mut u8 {
    // SAFETY: the size is not zero.
    layout(bytes).map_or(std::ptr::null_mut(), |layout| unsafe { alloc(layout) })
}

/// Frees memory from [`allocate`]. The number of bytes must be the same.
///
/// # Safety
/// The caller says so; NULL is no memory.
pub unsafe fn free(at: *mut u8, bytes: usize) {
    if let Some(layout) = layout(bytes).filter(|_| !at.is_null()) {
        // SAFETY: as here.
        unsafe { dealloc(at, layout) };
    }
}
