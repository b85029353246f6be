//! Replacements for the standard library in a WASM module: a panic handler and an allocator.
//!
//! A module links no standard library, no serializer and no text formatting. `docs/modules.md`
//! explains the reasons, and `tests/tests/it/modules.rs` checks the sizes of modules against
//! limits.

use core::alloc::{GlobalAlloc, Layout};
use core::arch::wasm32::{memory_grow, unreachable};
use core::panic::PanicInfo;

use crate::arena::{Arena, PAGE_BYTES};
use crate::platform::Lock;

/// Ends the instance without a message, because the code that formats a message is larger than a
/// small model.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    unreachable()
}

#[global_allocator]
static MEMORY: Memory = Memory(Lock::new(Arena::new()));

struct Memory(Lock<Arena>);

// SAFETY: the arena returns each live block only once. The block is aligned, is as large as its
// layout, and lies in memory from `memory.grow`. A block is freed with the layout of its
// allocation.
unsafe impl GlobalAlloc for Memory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let block = self.0.lock().and_then(|mut arena| arena.allocate(layout, grow));
        block.unwrap_or(core::ptr::null_mut())
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        if let Some(mut arena) = self.0.lock() {
            // SAFETY: guaranteed by the caller.
            unsafe { arena.give_back(block, layout) }
        }
    }
}

/// Returns the first byte of new pages at the end of the memory; `None` when memory is exhausted.
fn grow(pages: usize) -> Option<*mut u8> {
    let before = memory_grow::<0>(pages);
    (before != usize::MAX).then(|| (before * PAGE_BYTES) as *mut u8)
}
