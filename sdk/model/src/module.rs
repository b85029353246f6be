//! What the standard library does in larger programs: the end of a panic, and memory.

use core::alloc::{GlobalAlloc, Layout};
use core::arch::wasm32::{memory_grow, unreachable};
use core::panic::PanicInfo;

use crate::arena::{Arena, PAGE_BYTES};
use crate::platform::Lock;

/// Traps, without a text: putting one together takes more code than a small model.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    unreachable()
}

#[global_allocator]
static MEMORY: Memory = Memory(Lock::new(Arena::new()));

struct Memory(Lock<Arena>);

// SAFETY: the arena gives each block once, aligned and as large as its layout says, of memory that
// `memory.grow` made; it takes back what it gave, by the same layout.
unsafe impl GlobalAlloc for Memory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let block = self.0.lock().and_then(|mut arena| arena.take(layout, grow));
        block.unwrap_or(core::ptr::null_mut())
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        if let Some(mut arena) = self.0.lock() {
            // SAFETY: the caller's promise.
            unsafe { arena.give_back(block, layout) }
        }
    }
}

/// The first byte of as many new pages behind the memory; `None` when memory is exhausted.
fn grow(pages: usize) -> Option<*mut u8> {
    let before = memory_grow::<0>(pages);
    (before != usize::MAX).then(|| (before * PAGE_BYTES) as *mut u8)
}
