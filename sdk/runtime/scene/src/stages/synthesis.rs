//! The synthesis stage: a voice of the surface's model, scaled to an RMS of 1.

use htex_play::{Motion, SampleSource};

use super::Stage;

/// A voice at its model's own rate.
pub(crate) struct Synthesis {
    source: SampleSource,
    failed: Option<htex_play::Error>,
}

impl Synthesis {
    pub(crate) fn new(source: SampleSource) -> Self {
        Self { source, failed: None }
    }

    /// Retunes the voice to a motion and returns the level at this motion. If the model fails, the
    /// voice continues unchanged and the failure is stored.
    pub(crate) fn set_motion(&mut self, motion: Motion) -> f64 {
        match self.source.set_motion(motion) {
            Ok(level_rms) => level_rms,
            Err(error) => {
                self.failed.get_or_insert(error);
                self.source.level_rms()
            }
        }
    }

    /// Passes the motion of the finger, `at_s` seconds after the first sample, to a model that
    /// follows the motion itself. If the model refuses the motion, the voice continues unchanged
    /// and the failure is stored.
    pub(crate) fn follow_finger(&mut self, motion: Motion, at_s: f64) {
        if let Err(error) = self.source.follow(motion, at_s) {
            self.failed.get_or_insert(error);
        }
    }

    pub(crate) fn level_rms(&self) -> f64 {
        self.source.level_rms()
    }

    /// Returns and clears the first failure.
    pub(crate) fn take_failure(&mut self) -> Option<htex_play::Error> {
        self.failed.take()
    }
}

impl Stage for Synthesis {
    fn render(&mut self, out: &mut [f32], _source: &mut dyn FnMut(&mut [f32])) {
        if let Err(error) = self.source.render(out) {
            self.failed.get_or_insert(error);
        }
    }
}
