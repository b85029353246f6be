//! Memory that ends at the end of a page and is followed by protected pages (a fence). A signal
//! handler names the call that touched a fence.
//!
//! A debugger's allocator or an instrumented build could also detect such accesses. But the checker
//! must test the same file that is shipped.
#![allow(unsafe_code)] // Pages and signals are calls of the system.

use std::ffi::c_void;
use std::marker::PhantomData;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};

use crate::harness::Finding;
use libc::{c_int, siginfo_t};

/// Size of the protected memory behind an array, bytes. It takes no physical memory.
const FENCE: usize = 64 << 20;
/// Maximum number of arrays at a time.
const PLACES: usize = 32;

/// The fences of the arrays in use, for the signal handler: the start of each fence and the line to
/// print. A start of 0 marks a free place, and 1 a place that is being filled.
static STARTS: [AtomicUsize; PLACES] = [const { AtomicUsize::new(0) }; PLACES];
static LINES: [AtomicPtr<u8>; PLACES] = [const { AtomicPtr::new(std::ptr::null_mut()) }; PLACES];
static LENGTHS: [AtomicUsize; PLACES] = [const { AtomicUsize::new(0) }; PLACES];

/// Values that end where a fence begins.
pub(crate) struct Pages<T> {
    /// The mapping, including its fence.
    base: *mut c_void,
    bytes: usize,
    start: *mut T,
    len: usize,
    place: Option<usize>,
    /// The line that the handler prints.
    line: Box<[u8]>,
    values: PhantomData<T>,
}

// SAFETY: only this value owns the mapping.
unsafe impl<T: Send> Send for Pages<T> {}

impl<T: Copy + Default> Pages<T> {
    /// Creates space for values. `finding` is reported if the fence is touched.
    pub(crate) fn new(len: usize, finding: Finding) -> Self {
        let page = page_bytes();
        let used = (len * size_of::<T>()).div_ceil(page).max(1) * page;
        let bytes = used + FENCE;
        // SAFETY: a new mapping, of which the first part is made accessible.
        let base = unsafe {
            let flags = libc::MAP_PRIVATE | libc::MAP_ANONYMOUS | libc::MAP_NORESERVE;
            let base = libc::mmap(std::ptr::null_mut(), bytes, libc::PROT_NONE, flags, -1, 0);
            let writable = libc::PROT_READ | libc::PROT_WRITE;
            if base == libc::MAP_FAILED || libc::mprotect(base, used, writable) != 0 {
                std::alloc::handle_alloc_error(std::alloc::Layout::new::<T>());
            }
            base
        };
        let start = (base as usize + used - len * size_of::<T>()) as *mut T;
        let mut line = serde_json::to_vec(&finding).unwrap_or_default();
        line.push(b'\n');
        let mut pages = Self {
            base,
            bytes,
            start,
            len,
            place: None,
            line: line.into_boxed_slice(),
            values: PhantomData,
        };
        pages.place = pages.enter(base as usize + used);
        pages
    }

    /// Enters the fence into a free place.
    fn enter(&mut self, fence: usize) -> Option<usize> {
        let free = |start: &AtomicUsize| {
            let taken = start.compare_exchange(0, 1, Ordering::SeqCst, Ordering::SeqCst);
            taken.is_ok()
        };
        let place = STARTS.iter().position(free)?;
        LINES[place].store(self.line.as_mut_ptr(), Ordering::SeqCst);
        LENGTHS[place].store(self.line.len(), Ordering::SeqCst);
        // The start comes last: from then on the handler uses the line.
        STARTS[place].store(fence, Ordering::SeqCst);
        Some(place)
    }

    pub(crate) fn get(&mut self) -> &mut [T] {
        // SAFETY: the mapping holds `len` values here, which the system has set to zero; the values
        // are aligned because they end at the end of a page.
        unsafe { std::slice::from_raw_parts_mut(self.start, self.len) }
    }
}

impl<T> Drop for Pages<T> {
    fn drop(&mut self) {
        if let Some(place) = self.place {
            // The place is freed first, so that the handler no longer uses the line.
            STARTS[place].store(0, Ordering::SeqCst);
        }
        // SAFETY: this value owns the mapping, and nobody uses the mapping any more.
        unsafe { libc::munmap(self.base, self.bytes) };
    }
}

/// Installs a handler that prints the finding of a fence that is touched, and ends the process.
pub(crate) fn watch() {
    // SAFETY: the handler has the signature that SA_SIGINFO wants, and calls only what a handler
    // may call.
    unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        action.sa_sigaction = on_fault as *const () as usize;
        action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
        for signal in [libc::SIGSEGV, libc::SIGBUS] {
            libc::sigaction(signal, &raw const action, std::ptr::null_mut());
        }
    }
}

extern "C" fn on_fault(signal: c_int, info: *mut siginfo_t, _: *mut c_void) {
    // SAFETY: the system passes a description of the fault.
    let address = unsafe { (*info).si_addr() } as usize;
    for place in 0..PLACES {
        let start = STARTS[place].load(Ordering::SeqCst);
        if start > 1 && (start..start + FENCE).contains(&address) {
            let line = LINES[place].load(Ordering::SeqCst);
            // SAFETY: the line lives as long as its place is taken.
            unsafe {
                libc::write(1, line.cast(), LENGTHS[place].load(Ordering::SeqCst));
                libc::_exit(1);
            }
        }
    }
    // This is another fault. The same fault will happen again, and then the default action ends the
    // process. SAFETY: the default action.
    unsafe { libc::signal(signal, libc::SIG_DFL) };
}

fn page_bytes() -> usize {
    // SAFETY: the call only returns a number.
    usize::try_from(unsafe { libc::sysconf(libc::_SC_PAGESIZE) }).unwrap_or(4096)
}
