//! Reports the progress of a call to JavaScript (`sdk/bindings/web/src/guests.js`).

use std::cell::Cell;

#[cfg(target_family = "wasm")]
mod imported {
    #[link(wasm_import_module = "htex")]
    unsafe extern "C" {
        /// Reports that a step begins, after `done` of `of` steps are finished. The text describes
        /// the step.
        pub(super) fn progress(done: u32, of: u32, text: *const u8, len: usize);
    }
}

thread_local! {
    /// Number of steps that have begun, and the total number of steps.
    static STEPS: Cell<(u32, u32)> = const { Cell::new((0, 0)) };
}

/// Starts counting the steps of a call.
pub(crate) fn start(steps: usize) {
    STEPS.set((0, steps as u32));
}

/// Reports that the next step begins. The text is `what` the step does and `with` what. Reports
/// nothing if the call does not count steps.
pub(crate) fn begin(what: &str, with: &str) {
    let (done, of) = STEPS.get();
    if of > 0 {
        STEPS.set((done + 1, of));
        tell(done, of, &format!("{what} {with}"));
    }
}

/// Stops counting steps.
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
