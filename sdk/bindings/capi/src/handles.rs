//! Handles of objects. A handle holds an index and a generation. The generation shows whether the
//! object was freed.
//!
//! A lookup neither locks nor allocates. At any time, either one thread uses an object exclusively,
//! or any number of threads read it. A counter in the object's slot enforces this rule: a call that
//! would break the rule fails at once. A handle also contains the kind of its object, so passing a
//! voice where an asset is expected is an error.

use std::cell::UnsafeCell;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicPtr, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::status::{Failure, htex_status};

/// Chunk `c` has `FIRST << c` slots.
const FIRST: usize = 64;
const CHUNKS: usize = 20;

/// The lower half of a handle holds the kind in its upper bits, and the index plus one in the bits
/// below.
// 5 of the 32 bits remain for the kind.
const KIND_SHIFT: u32 = 27;
const _: () = assert!(FIRST << CHUNKS <= 1 << KIND_SHIFT);

/// The kinds of objects.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Kind {
    Asset = 1,
    Voice = 2,
    #[cfg(all(feature = "library", not(target_family = "wasm")))]
    Library = 3,
    #[cfg(feature = "scene")]
    Scene = 4,
    #[cfg(feature = "scene")]
    Device = 6,
    #[cfg(all(target_family = "wasm", feature = "library"))]
    Index = 5,
}

/// Value of a slot's number of users while one thread uses the object exclusively.
const EXCLUSIVE: u64 = u32::MAX as u64;
/// Largest number of threads that can read an object at the same time; far more than a program has.
const MOST_USERS: u64 = EXCLUSIVE - 1;

/// The objects of one kind.
pub(crate) struct Table<T> {
    kind: Kind,
    chunks: [AtomicPtr<Slot<T>>; CHUNKS],
    spare: Mutex<Spare>,
}

/// The free indices, and the number of indices that were created since the table was last cleared.
struct Spare {
    free: Vec<usize>,
    made: usize,
    /// Generation of a slot that was never used. It is greater than the generations of all handles
    /// from before the table was cleared.
    unused: u64,
}

/// A slot for an object.
struct Slot<T> {
    /// The upper half is the generation, which is odd while the slot holds an object. The lower
    /// half is the number of users.
    state: AtomicU64,
    /// Boxed, so that a slot without an object takes little memory.
    value: UnsafeCell<Option<Box<T>>>,
}

// SAFETY: `state` controls all access to the value: either one thread uses it exclusively, or
// several threads read it. `Table::shared` allows several readers only if the value is `Sync`.
unsafe impl<T: Send> Sync for Slot<T> {}

const fn generation(state: u64) -> u64 {
    state >> 32
}

const fn users(state: u64) -> u64 {
    state & EXCLUSIVE
}

impl<T: Send + 'static> Table<T> {
    pub(crate) const fn new(kind: Kind) -> Self {
        Self {
            kind,
            chunks: [const { AtomicPtr::new(std::ptr::null_mut()) }; CHUNKS],
            spare: Mutex::new(Spare { free: Vec::new(), made: 0, unused: 0 }),
        }
    }

    /// Stores an object and returns its handle, which is never 0. Allocates and locks.
    pub(crate) fn insert(&self, value: T) -> Result<u64, Failure> {
        let value = Box::new(value);
        let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        let index = match spare.free.pop() {
            Some(index) => index,
            None => {
                let index = spare.made;
                self.make_chunk(index, spare.unused)?;
                spare.made += 1;
                index
            }
        };
        let Some(slot) = self.slot(index) else {
            return Err(FULL);
        };
        let next = generation(slot.state.load(Ordering::Relaxed)) + 1;
        // A generation is never used twice; see `remove`.
        if next >= EXCLUSIVE {
            return Err(FULL);
        }
        // SAFETY: the slot is empty, its index was spare, and the lock is held.
        unsafe { *slot.value.get() = Some(value) };
        // The state is stored after the value, so that a thread that sees the new generation also
        // sees the value.
        slot.state.store(next << 32, Ordering::Release);
        Ok(next << 32 | (self.kind as u64) << KIND_SHIFT | (index as u64 + 1))
    }

    /// Allocates the chunk of an index if this is the first index in the chunk.
    fn make_chunk(&self, index: usize, unused: u64) -> Result<(), Failure> {
        let (chunk, _) = place(index);
        let pointer = self.chunks.get(chunk).ok_or(FULL)?;
        if pointer.load(Ordering::Relaxed).is_null() {
            let slots: Box<[Slot<T>]> = (0..FIRST << chunk)
                .map(|_| Slot { state: AtomicU64::new(unused << 32), value: UnsafeCell::new(None) })
                .collect();
            // Slots live until `clear`, because stale handles are still looked up in them.
            pointer.store(Box::leak(slots).as_mut_ptr(), Ordering::Release);
        }
        Ok(())
    }

    fn slot(&self, index: usize) -> Option<&'static Slot<T>> {
        let (chunk, offset) = place(index);
        let slots = self.chunks.get(chunk)?.load(Ordering::Acquire);
        // SAFETY: a chunk that is there has `FIRST << chunk` slots, which only `clear` frees.
        (!slots.is_null()).then(|| unsafe { &*slots.add(offset) })
    }

    /// Returns the slot of a handle, its generation and its index.
    fn find(&self, handle: u64) -> Result<(&'static Slot<T>, u64, usize), Failure> {
        let low = handle & EXCLUSIVE;
        if low >> KIND_SHIFT != self.kind as u64 {
            return Err(BAD);
        }
        let index = low & ((1 << KIND_SHIFT) - 1);
        let index = index.checked_sub(1).ok_or(BAD)? as usize;
        let slot = self.slot(index).ok_or(BAD)?;
        let wanted = generation(handle);
        // This is only a first check, so a relaxed load suffices: `enter` checks the generation
        // again. An even generation marks an empty slot.
        if wanted.is_multiple_of(2) || generation(slot.state.load(Ordering::Relaxed)) != wanted {
            return Err(BAD);
        }
        Ok((slot, wanted, index))
    }

    /// Applies `change` to the number of users of a slot that has this generation. `change` returns
    /// `None` if the caller may not use the object now.
    fn enter(
        slot: &Slot<T>,
        wanted: u64,
        change: impl Fn(u64) -> Option<u64>,
    ) -> Result<(), Failure> {
        // Pairs with the release stores in `insert` and in the `drop` of earlier users.
        let result = slot.state.fetch_update(Ordering::Acquire, Ordering::Relaxed, |state| {
            (generation(state) == wanted)
                .then(|| change(users(state)).map(|users| wanted << 32 | users))
                .flatten()
        });
        match result {
            Ok(_) => Ok(()),
            Err(state) if generation(state) == wanted => Err(BUSY),
            Err(_) => Err(BAD),
        }
    }

    /// Returns the object of a handle for exclusive use, until the result is dropped.
    pub(crate) fn exclusive(&self, handle: u64) -> Result<Exclusive<T>, Failure> {
        let (slot, wanted, _) = self.find(handle)?;
        Self::enter(slot, wanted, |users| (users == 0).then_some(EXCLUSIVE))?;
        // SAFETY: the slot is of this generation, so it has an object, and this is its only user.
        match unsafe { &mut *slot.value.get() } {
            Some(value) => Ok(Exclusive { value: &mut **value, slot }),
            None => Err(BAD),
        }
    }

    /// Returns the object of a handle for reading. Other threads may read it at the same time.
    pub(crate) fn shared(&self, handle: u64) -> Result<Shared<T>, Failure>
    where
        T: Sync,
    {
        let (slot, wanted, _) = self.find(handle)?;
        Self::enter(slot, wanted, |users| (users < MOST_USERS).then_some(users + 1))?;
        // SAFETY: the slot is of this generation, so it has an object, and all its users read.
        match unsafe { &*slot.value.get() } {
            Some(value) => Ok(Shared { value: &**value, slot }),
            None => Err(BAD),
        }
    }

    /// Removes an object and returns it. Its handle is then invalid.
    pub(crate) fn remove(&self, handle: u64) -> Result<T, Failure> {
        let (slot, wanted, index) = self.find(handle)?;
        Self::enter(slot, wanted, |users| (users == 0).then_some(EXCLUSIVE))?;
        // SAFETY: this is the only user.
        let value = unsafe { (*slot.value.get()).take() };
        slot.state.store(((wanted + 1) & EXCLUSIVE) << 32, Ordering::Release);
        // The index is freed only after the slot is empty, because the next `insert` may take the
        // slot at once.
        let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        // A slot that reached the last generation is not used again: its counter would start at 0
        // again, and an old handle would match a new object.
        if wanted + 1 < EXCLUSIVE {
            spare.free.push(index);
        }
        value.map(|value| *value).ok_or(BAD)
    }

    /// Frees all objects and slots. Their handles stay invalid afterwards. If an object is in use,
    /// frees nothing and returns an error.
    ///
    /// # Safety
    /// No other thread uses this table during the call.
    pub(crate) unsafe fn clear(&self) -> Result<(), Failure> {
        let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        let mut highest = spare.unused;
        // Checks all slots before anything is freed, so that the table stays as it is if an object
        // is in use.
        for slot in (0..spare.made).filter_map(|index| self.slot(index)) {
            let state = slot.state.load(Ordering::Acquire);
            if users(state) != 0 {
                return Err(BUSY);
            }
            highest = highest.max(generation(state));
        }
        for (chunk, pointer) in self.chunks.iter().enumerate() {
            let slots = pointer.swap(std::ptr::null_mut(), Ordering::AcqRel);
            if !slots.is_null() {
                let slots = std::ptr::slice_from_raw_parts_mut(slots, FIRST << chunk);
                // SAFETY: `make_chunk` leaked a box of as many slots, and nobody refers to them.
                drop(unsafe { Box::from_raw(slots) });
            }
        }
        *spare = Spare {
            free: Vec::new(),
            made: 0,
            // The generation is even, because the slot holds no object.
            unused: highest.next_multiple_of(2),
        };
        Ok(())
    }
}

/// Returns the chunk that contains an index, and the offset in this chunk.
const fn place(index: usize) -> (usize, usize) {
    let chunk = (index / FIRST + 1).ilog2() as usize;
    (chunk, index - FIRST * ((1 << chunk) - 1))
}

const BAD: Failure = Failure::plain(
    htex_status::HTEX_STATUS_BAD_HANDLE,
    "no such object; it may have been freed, or be of another kind",
);
const BUSY: Failure = Failure::plain(
    htex_status::HTEX_STATUS_BUSY,
    "another thread uses the object; use it from one thread at a time",
);
const FULL: Failure = Failure::plain(
    htex_status::HTEX_STATUS_INTERNAL,
    "67 million objects of a kind are in use; free some",
);

/// Gives one thread exclusive use of an object, until the guard is dropped.
pub(crate) struct Exclusive<T: 'static> {
    value: &'static mut T,
    slot: &'static Slot<T>,
}

/// Lets this thread read an object, until the guard is dropped. Other threads may read the object at
/// the same time.
pub(crate) struct Shared<T: 'static> {
    value: &'static T,
    slot: &'static Slot<T>,
}

impl<T> Deref for Exclusive<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.value
    }
}

impl<T> DerefMut for Exclusive<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.value
    }
}

impl<T> Drop for Exclusive<T> {
    fn drop(&mut self) {
        // While a slot is used exclusively, no other thread changes its state, so a plain store
        // suffices.
        let state = self.slot.state.load(Ordering::Relaxed);
        self.slot.state.store(state & !EXCLUSIVE, Ordering::Release);
    }
}

impl<T> Deref for Shared<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.value
    }
}

impl<T> Drop for Shared<T> {
    fn drop(&mut self) {
        self.slot.state.fetch_sub(1, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
    use super::*;

    #[test]
    fn indices_fill_the_chunks_one_after_the_other() {
        let mut next = (0, 0);
        for index in 0..100_000 {
            assert_eq!(place(index), next);
            next.1 += 1;
            if next.1 == FIRST << next.0 {
                next = (next.0 + 1, 0);
            }
        }
    }

    #[test]
    fn freed_handles_and_other_numbers_are_bad() {
        static TABLE: Table<String> = Table::new(Kind::Asset);
        let a = TABLE.insert("a".to_owned()).unwrap();
        assert_eq!(TABLE.remove(a).unwrap(), "a");
        let b = TABLE.insert("b".to_owned()).unwrap();
        assert_ne!(a, b);
        for bad in [0, a, b + 1, b ^ 1 << 32, b + (1 << 33), u64::MAX, 1] {
            assert!(TABLE.shared(bad).is_err(), "{bad:#x}");
            assert!(TABLE.exclusive(bad).is_err(), "{bad:#x}");
            assert!(TABLE.remove(bad).is_err(), "{bad:#x}");
        }
        assert_eq!(*TABLE.shared(b).unwrap(), "b");
        static VOICES: Table<String> = Table::new(Kind::Voice);
        let voice = VOICES.insert("c".to_owned()).unwrap();
        assert_eq!(TABLE.insert("d".to_owned()).unwrap() >> 32, voice >> 32);
        assert!(TABLE.shared(voice).is_err() && TABLE.remove(voice).is_err());
    }

    #[test]
    fn handles_from_before_a_table_was_cleared_are_bad() {
        static TABLE: Table<u32> = Table::new(Kind::Asset);
        let before: Vec<u64> = (0..100).map(|n| TABLE.insert(n).unwrap()).collect();
        TABLE.remove(before[7]).unwrap();
        {
            let _used = TABLE.shared(before[3]).unwrap();
            // SAFETY: this thread alone uses the table.
            assert!(unsafe { TABLE.clear() }.is_err());
        }
        assert_eq!(*TABLE.shared(before[99]).unwrap(), 99);
        // SAFETY: as above.
        unsafe { TABLE.clear() }.unwrap();
        let after: Vec<u64> = (0..100).map(|n| TABLE.insert(n).unwrap()).collect();
        assert!(before.iter().all(|handle| TABLE.shared(*handle).is_err()));
        assert!(after.iter().all(|handle| TABLE.shared(*handle).is_ok()));
    }

    #[test]
    fn an_object_has_one_user_or_several_readers() {
        static TABLE: Table<u32> = Table::new(Kind::Asset);
        let handle = TABLE.insert(1).unwrap();
        {
            let (_a, _b) = (TABLE.shared(handle).unwrap(), TABLE.shared(handle).unwrap());
            assert!(TABLE.exclusive(handle).is_err() && TABLE.remove(handle).is_err());
        }
        {
            let mut only = TABLE.exclusive(handle).unwrap();
            *only += 1;
            assert!(TABLE.shared(handle).is_err() && TABLE.exclusive(handle).is_err());
        }
        assert_eq!(TABLE.remove(handle).unwrap(), 2);
    }

    /// Threads make, use and free objects, and try each other's handles. No update is lost, and no
    /// handle finds another object.
    #[test]
    fn threads_meet_at_one_table() {
        static TABLE: Table<(u64, u64)> = Table::new(Kind::Asset);
        static LAST: AtomicU64 = AtomicU64::new(0);
        std::thread::scope(|scope| {
            for thread in 0..4 {
                scope.spawn(move || {
                    for round in 0..2_000 {
                        let handle = TABLE.insert((thread, 0)).unwrap();
                        LAST.store(handle, Ordering::Relaxed);
                        for n in 0..3 {
                            let mut object = loop {
                                match TABLE.exclusive(handle) {
                                    Ok(object) => break object,
                                    Err(_) => std::thread::yield_now(),
                                }
                            };
                            assert_eq!(*object, (thread, n), "round {round}");
                            object.1 += 1;
                        }
                        if let Ok(other) = TABLE.shared(LAST.load(Ordering::Relaxed)) {
                            assert!(other.0 < 4 && other.1 <= 3);
                        }
                        while TABLE.remove(handle).is_err() {
                            std::thread::yield_now();
                        }
                        assert!(TABLE.shared(handle).is_err());
                    }
                });
            }
        });
    }
}
