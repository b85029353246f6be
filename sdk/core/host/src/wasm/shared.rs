//! The data that all instances of a module share.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The number of a module's voices, and whether it has the extension `htex.motion/1`.
#[derive(Debug, Default)]
pub(super) struct Shared {
    voices: AtomicUsize,
    follows_motion: AtomicBool,
}

impl Shared {
    /// Returns whether instances must have the functions of `htex.motion/1`.
    pub(super) fn follows_motion(&self) -> bool {
        self.follows_motion.load(Ordering::Relaxed)
    }

    /// Requires that all later instances have the functions of `htex.motion/1`.
    pub(super) fn require_motion(&self) {
        self.follows_motion.store(true, Ordering::Relaxed);
    }

    /// Counts one more voice. Returns `None` if there are already `most` voices.
    pub(super) fn place(self: &Arc<Self>, most: usize) -> Option<VoicePlace> {
        let take = |n: usize| (n < most).then_some(n + 1);
        let taken = self.voices.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take);
        taken.ok().map(|_| VoicePlace(Arc::clone(self)))
    }
}

/// Counts one voice. The count is decreased when this value is dropped.
pub(super) struct VoicePlace(Arc<Shared>);

impl Drop for VoicePlace {
    fn drop(&mut self) {
        self.0.voices.fetch_sub(1, Ordering::Relaxed);
    }
}
