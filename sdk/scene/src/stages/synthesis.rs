//! The samples themselves: a voice of the surface's model, of unit RMS.

use htex_play::{Motion, Source};

use super::Stage;

/// A voice at its model's own rate.
pub(crate) struct Synthesis {
    source: Source,
    failed: Option<htex_play::Error>,
}

impl Synthesis {
    pub(crate) fn new(source: Source) -> Self {
        Self {
            source,
            failed: None,
        }
    }

    /// The level after gliding to a motion. A model that cannot follow plays on as before, and says
    /// so.
    pub(crate) fn set_motion(&mut self, motion: Motion) -> f64 {
        match self.source.set_motion(motion) {
            Ok(level_rms) => level_rms,
            Err(error) => {
                self.failed.get_or_insert(error);
                self.source.level_rms()
            }
        }
    }

    pub(crate) fn level_rms(&self) -> f64 {
        self.source.level_rms()
    }

    /// The first failure since this was last asked.
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
