//! The memory allocator of a WASM module. Blocks belong to size classes, and each class has a list
//! of its freed blocks. This allocator has a tenth of the code of a general allocator.
//!
//! There are four size classes for each doubling of the size, so a block is at most a quarter
//! larger than requested, apart from rounding up to a multiple of 16 bytes. A freed block is reused
//! only for blocks of the same class. This restriction costs models little, because they allocate
//! the same sizes again and again.

use core::alloc::Layout;
use core::ptr::null_mut;

/// Size of a page, bytes: WASM memory grows by whole pages.
pub(crate) const PAGE_BYTES: usize = 65_536;
/// Size of the smallest block, and alignment of all blocks, bytes. The alignment is enough for
/// every number and vector.
const ALIGN: usize = 16;
/// Size classes per octave.
const STEPS: usize = 4;
const CLASSES: usize = STEPS * (usize::BITS as usize + 1);

/// Memory that grows and never moves, divided into blocks.
pub(crate) struct Arena {
    /// For each class, the block that was freed last. A freed block contains the address of the
    /// block that was freed before it.
    freed: [*mut u8; CLASSES],
    /// Start of the memory that does not belong to a block yet.
    fresh: *mut u8,
    fresh_len: usize,
}

impl Arena {
    /// Makes an arena without memory.
    pub(crate) const fn new() -> Self {
        Self { freed: [null_mut(); CLASSES], fresh: null_mut(), fresh_len: 0 }
    }

    /// Returns a block for a layout. `grow` returns new pages. Returns `None` if `grow` has no more
    /// pages, or if the alignment is above 16 bytes.
    pub(crate) fn allocate(
        &mut self,
        layout: Layout,
        grow: impl FnOnce(usize) -> Option<*mut u8>,
    ) -> Option<*mut u8> {
        if layout.align() > ALIGN {
            return None;
        }
        let (class, len) = class(layout.size())?;
        let block = self.freed[class];
        if block.is_null() {
            return self.allocate_fresh(len, grow);
        }
        // SAFETY: this is a freed block. `give_back` wrote to it the address of the block that was
        // freed before it.
        self.freed[class] = unsafe { block.cast::<*mut u8>().read() };
        Some(block)
    }

    fn allocate_fresh(
        &mut self,
        len: usize,
        grow: impl FnOnce(usize) -> Option<*mut u8>,
    ) -> Option<*mut u8> {
        if len > self.fresh_len {
            // There are enough pages for the whole block, because new pages may not directly follow
            // the old pages.
            let pages = len.div_ceil(PAGE_BYTES);
            let new = grow(pages)?;
            // If the new pages directly follow the old pages, they extend them. Otherwise the rest
            // of the old pages is lost.
            if new != self.fresh.wrapping_add(self.fresh_len) {
                (self.fresh, self.fresh_len) = (new, 0);
            }
            self.fresh_len += pages * PAGE_BYTES;
        }
        let block = self.fresh;
        self.fresh = block.wrapping_add(len);
        self.fresh_len -= len;
        Some(block)
    }

    /// Takes back a block, so that it can be reused.
    ///
    /// # Safety
    /// [`Self::allocate`] returned the block for this layout, and nothing uses it any more.
    pub(crate) unsafe fn give_back(&mut self, block: *mut u8, layout: Layout) {
        let Some((class, _)) = class(layout.size()) else {
            return;
        };
        // SAFETY: a block of this arena, aligned and larger than an address.
        unsafe { block.cast::<*mut u8>().write(self.freed[class]) };
        self.freed[class] = block;
    }
}

/// Returns the size class for blocks of at least `size` bytes, and their size in bytes.
fn class(size: usize) -> Option<(usize, usize)> {
    let size = size.max(ALIGN);
    let octave = size.ilog2() as usize;
    // The size is at least 16, so the step is never 0.
    let step = (1 << octave) / STEPS;
    let steps = size.div_ceil(step);
    let len = steps.checked_mul(step)?.checked_next_multiple_of(ALIGN)?;
    // If rounding up gives a size of the next octave, this number is the first class of that
    // octave.
    Some((STEPS * octave + steps - STEPS, len))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// The test allocates and frees blocks of all sizes in mixed order. The blocks never overlap,
    /// keep their content, are aligned, and are reused.
    #[test]
    fn blocks_are_apart_and_used_again() {
        const PAGES: usize = 512;
        let mut memory = std::vec![[0u128; PAGE_BYTES / 16]; PAGES];
        let start = memory.as_mut_ptr().cast::<u8>();
        let mut used = 0;
        let mut arena = Arena::new();
        let mut live: Vec<(*mut u8, Layout, u8)> = Vec::new();
        let mut random = 1_u64;
        for round in 0..20_000_u32 {
            random = random.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            let draw = (random >> 33) as usize;
            if live.len() > 100 {
                let (block, layout, mark) = live.swap_remove(draw % live.len());
                // SAFETY: a live block of this layout.
                let bytes = unsafe { core::slice::from_raw_parts(block, layout.size()) };
                assert!(bytes.iter().all(|&byte| byte == mark));
                // SAFETY: as it was taken.
                unsafe { arena.give_back(block, layout) };
                continue;
            }
            let size = (draw & 0xff_ffff) >> (draw % 24);
            let layout = Layout::from_size_align(size, 1 << (draw % 5)).unwrap();
            let block = arena.allocate(layout, |pages| {
                used += pages;
                (used <= PAGES).then(|| start.wrapping_add((used - pages) * PAGE_BYTES))
            });
            let Some(block) = block else { continue };
            assert!((block as usize).is_multiple_of(ALIGN));
            // SAFETY: the block has the requested number of bytes.
            unsafe { block.write_bytes(round as u8, size) };
            live.push((block, layout, round as u8));
        }
        assert!(live.len() > 50);
    }

    #[test]
    fn classes_hold_what_is_asked_for_and_a_quarter_more_at_most() {
        for size in (0..10_000).chain([1 << 20, (1 << 30) + 1]) {
            let (number, len) = class(size).unwrap();
            assert!(number < CLASSES && len >= size, "{size}");
            assert!(len <= (size + size / 4).next_multiple_of(ALIGN).max(ALIGN), "{size}");
        }
        assert!(class(usize::MAX).is_none());
    }
}
