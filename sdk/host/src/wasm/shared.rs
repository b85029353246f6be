//! What the instances of a module share.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::module::WasmModule;

/// The voices of a module, and whether it has the extension `htex.motion/1`.
#[derive(Debug, Default)]
pub(super) struct Shared {
    voices: AtomicUsize,
    follows_motion: AtomicBool,
}

impl WasmModule {
    /// Returns whether instances must have the functions of `htex.motion/1`.
    pub(super) fn follows_motion(&self) -> bool {
        self.shared.follows_motion.load(Ordering::Relaxed)
    }

    /// Requires the functions of `htex.motion/1` of all later instances.
    pub(super) fn require_motion(&self) {
        self.shared.follows_motion.store(true, Ordering::Relaxed);
    }

    /// Counts one more voice; `None` at the limit.
    pub(super) fn place(self: &Arc<Self>) -> Option<VoicePlace> {
        let most = self.limits.voices;
        let take = |n: usize| (n < most).then_some(n + 1);
        let taken = self
            .shared
            .voices
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, take);
        taken.ok().map(|_| VoicePlace(Arc::clone(self)))
    }
}

/// The count of one voice, released when it is dropped.
pub(super) struct VoicePlace(Arc<WasmModule>);

impl Drop for VoicePlace {
    fn drop(&mut self) {
        self.0.shared.voices.fetch_sub(1, Ordering::Relaxed);
    }
}
