//! The voices of one exported model, found by their handles.
//!
//! Looking up a voice takes no lock. A handle becomes invalid when its voice is freed.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, Ordering};

use crate::platform::{Lock, Once};

/// Slots in the first chunk. Chunk `c` has `FIRST << c` slots, and is allocated when it gets its
/// first voice. Therefore, a model with one voice needs only the memory of a few slots (up to 2.8
/// kB each). A model with a thousand voices allocates at most twice as many slots as it uses.
const FIRST: usize = 4;
/// Largest number of voices at a time. It is smaller in a WASM module, because an instance of a
/// module has only one or two voices.
const MOST: usize = if cfg!(target_family = "wasm") { 1024 } else { 65_536 };
/// Number of chunks for `MOST` slots.
const CHUNKS: usize = place(MOST - 1).0 + 1;

/// Returns the chunk of a slot index, and the slot's offset in that chunk.
const fn place(index: usize) -> (usize, usize) {
    let chunk = (index / FIRST + 1).ilog2() as usize;
    (chunk, index - FIRST * ((1 << chunk) - 1))
}

/// A collection of up to 65,536 voices (1,024 in a WASM module), accessed by handles.
///
/// A handle consists of a slot's index and the slot's generation, which changes whenever a voice is
/// inserted or removed. Therefore, the handle of a removed voice stays invalid even when its slot
/// is used again.
pub(crate) struct Voices<V> {
    chunks: [Once<Box<[Slot<V>]>>; CHUNKS],
    free: Lock<Free>,
}

struct Slot<V> {
    /// The generation is odd while the slot contains a voice.
    generation: AtomicU32,
    voice: UnsafeCell<Option<V>>,
}

struct Free {
    freed: Vec<u32>,
    never_used: u32,
}

// SAFETY: only two kinds of callers access a slot's voice. The first is a thread that inserts or
// removes the voice, and this thread holds the lock of `free`. The second is `get`, whose caller
// guarantees exclusive access to the voice.
unsafe impl<V: Send> Sync for Voices<V> {}

impl<V> Default for Voices<V> {
    fn default() -> Self {
        Self::new()
    }
}

impl<V> Voices<V> {
    /// Makes an empty collection.
    pub(crate) const fn new() -> Self {
        Self {
            chunks: [const { Once::new() }; CHUNKS],
            free: Lock::new(Free { freed: Vec::new(), never_used: 0 }),
        }
    }

    /// Inserts a voice and returns its handle, or `None` if there are too many voices.
    pub(crate) fn insert(&self, voice: V) -> Option<i64> {
        let mut free = self.free.lock()?;
        let index = match free.freed.pop() {
            Some(index) => index,
            None if (free.never_used as usize) < MOST => {
                free.never_used += 1;
                free.never_used - 1
            }
            None => return None,
        };
        // Chunks are never moved or freed, so other threads may find their slots without the lock.
        let (chunk, offset) = place(index as usize);
        let slots = self.chunks[chunk].get_or_init(|| {
            let slot = || Slot { generation: AtomicU32::new(0), voice: UnsafeCell::new(None) };
            (0..FIRST << chunk).map(|_| slot()).collect()
        });
        let slot = &slots[offset];
        // SAFETY: the slot's index came from the free list, whose lock is held. Therefore, the slot
        // is free, and no valid handle to it exists.
        unsafe { *slot.voice.get() = Some(voice) };
        // The generation is changed with `Release` after the voice was written, so that a thread
        // that sees the new generation also sees the voice.
        let generation = slot.generation.fetch_add(1, Ordering::Release) + 1;
        // The handle contains 31 bits of the generation, and the index plus one. So it is above
        // zero.
        Some((i64::from(generation & 0x7fff_ffff) << 32) | i64::from(index + 1))
    }

    /// Returns the voice of a handle, or `None` if it was removed or never existed.
    ///
    /// # Safety
    /// While the reference is in use, no other thread uses or frees this voice, and the caller
    /// holds no second reference to it.
    #[allow(clippy::mut_from_ref)]
    pub(crate) unsafe fn get(&self, handle: i64) -> Option<&mut V> {
        let slot = self.live_slot(handle)?;
        // SAFETY: the slot is live, and the caller guarantees exclusive access.
        unsafe { (*slot.voice.get()).as_mut() }
    }

    /// Removes a voice and returns it, or `None` if the handle is not valid.
    pub(crate) fn remove(&self, handle: i64) -> Option<V> {
        let mut free = self.free.lock()?;
        let slot = self.live_slot(handle)?;
        // From here on, the handle is stale.
        slot.generation.fetch_add(1, Ordering::Release);
        free.freed.push((handle & 0xffff_ffff) as u32 - 1);
        // SAFETY: the slot was live, and its generation was changed under the lock.
        unsafe { (*slot.voice.get()).take() }
    }

    fn live_slot(&self, handle: i64) -> Option<&Slot<V>> {
        let index = usize::try_from((handle & 0xffff_ffff) - 1).ok()?;
        let (chunk, offset) = place(index);
        let slot = self.chunks.get(chunk)?.get()?.get(offset)?;
        // The counterpart of `Release` in `insert`.
        let generation = slot.generation.load(Ordering::Acquire);
        // For a negative handle, the highest bit of `wanted` is set. No stored generation has this
        // bit. After 2³⁰ voices in one slot, the slot's first handle would become valid again.
        let wanted = (handle >> 32) as u32;
        (generation % 2 == 1 && generation & 0x7fff_ffff == wanted).then_some(slot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stale_and_invented_handles_are_refused() {
        let voices = Voices::new();
        let a = voices.insert("a").unwrap();
        let b = voices.insert("b").unwrap();
        assert_eq!(voices.remove(a), Some("a"));
        let c = voices.insert("c").unwrap();
        // SAFETY: one thread.
        unsafe {
            assert_eq!(voices.get(a), None);
            assert_eq!(voices.get(b).copied(), Some("b"));
            assert_eq!(voices.get(c).copied(), Some("c"));
            for bad in [0, -1, i64::MIN, i64::MAX, c + 1, 1] {
                assert_eq!(voices.get(bad), None);
            }
        }
        assert_eq!(voices.remove(a), None);
    }

    /// When chunks are added, the voices in earlier chunks keep their places.
    #[test]
    fn chunks_are_made_as_needed() {
        let voices = Voices::new();
        let allocated = |voices: &Voices<usize>| {
            let chunks = voices.chunks.iter().filter_map(Once::get);
            chunks.map(|slots| slots.len()).sum::<usize>()
        };
        let handles: Vec<i64> = (0..1_000).map(|n| voices.insert(n).unwrap()).collect();
        assert!(allocated(&voices) < 2_048);
        for (n, handle) in handles.iter().enumerate() {
            // SAFETY: one thread.
            assert_eq!(unsafe { voices.get(*handle) }.copied(), Some(n));
        }
        let one = Voices::new();
        one.insert(0).unwrap();
        assert_eq!(allocated(&one), FIRST);
    }

    #[test]
    fn voices_above_the_limit_are_refused() {
        let voices = Voices::new();
        let first = voices.insert(()).unwrap();
        for _ in 1..MOST {
            voices.insert(()).unwrap();
        }
        assert_eq!(voices.insert(()), None);
        assert_eq!(voices.remove(first), Some(()));
        assert!(voices.insert(()).is_some());
    }
}
