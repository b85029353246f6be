//! How far a call is, told to JavaScript (`sdk/web/src/guests.js`).

use std::cell::Cell;

#[cfg(target_family = "wasm")]
mod imported {
    #[link(wasm_import_module = "htex")]
    unsafe extern "C" {
        /// The step `done` of `of` begins, which is described by a text.
        pub(super) fn progress(done: u32, of: u32, text: *const u8, len: usize);
    }
}

thread_local! {
    /// Steps that have begun, and all of them.
    static STEPS: Cell<(u32, u32)> = const { Cell::new((0, 0)) };
}

/// Begins to count the steps of a call.
pub(crate) fn start(steps: usize) {
    STEPS.set((0, steps as u32));
}

/// Tells that the next step begins: what is done, and with what. Nothing is told of a call that
/// does not count steps.
pub(crate) fn begin(what: &str, with: &str) {
    let (done, of) = STEPS.get();
    if of > 0 {
        STEPS.set((done + 1, of));
        tell(done, of, &format!("{what} {with}"));
    }
}

/// Ends the count.
pub(crate) fn end() {
    STEPS.set((0, 0));
}

#[cfg(target_family = "wasm")]
fn tell(done: u32, of: u32, text: &str) {
    // SAFETY: a live text.
    unsafe { imported::progress(done, of, text.as_ptr(), text.len()) };
}

#[cfg(not(target_family = "wasm"))]
fn tell(_done: u32, _of: u32, _text: &str) {}
