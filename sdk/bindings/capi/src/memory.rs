//! Memory that JavaScript and the library pass to each other. One side allocates the memory, and
//! the other side frees it.

use std::alloc::{Layout, alloc, dealloc};

/// Alignment of all allocations.
const ALIGNMENT: usize = 8;

fn layout(bytes: usize) -> Option<Layout> {
    // `alloc` must not get a size of 0.
    let size = bytes.max(1);
    Layout::from_size_align(size, ALIGNMENT).ok()
}

/// Allocates bytes, aligned to 8. Returns NULL if there is not enough memory.
pub fn allocate(bytes: usize) -> *mut u8 {
    // SAFETY: the size is not zero.
    layout(bytes).map_or(std::ptr::null_mut(), |layout| unsafe { alloc(layout) })
}

/// Frees memory from [`allocate`]. `bytes` must be the number of bytes that was allocated.
///
/// # Safety
/// The pointer must be NULL, or it must come from [`allocate`] with the same number of bytes and
/// its memory must not have been freed before.
pub unsafe fn free(at: *mut u8, bytes: usize) {
    if let Some(layout) = layout(bytes).filter(|_| !at.is_null()) {
        // SAFETY: as here.
        unsafe { dealloc(at, layout) };
    }
}
