//! Multiplies samples of unit RMS by the asset's level and the surface's gain. The result is in the
//! asset's unit.

use htex_dsp::glide::Glide;

use super::{Context, Stage};
use crate::played::PlayedSurface;

/// Duration of a change of level, seconds.
const RAMP_S: f64 = 0.010;

pub(crate) struct Level {
    gain: f64,
    level: Glide,
}

impl Level {
    pub(crate) fn new(played: &PlayedSurface, level_rms: f64) -> Self {
        let ramp = (RAMP_S * played.rate_hz).ceil() as u32;
        Self { gain: played.gain, level: Glide::new((played.gain * level_rms) as f32, ramp) }
    }
}

impl Stage for Level {
    fn follow(&mut self, context: &Context) {
        self.level.set((self.gain * context.level_rms) as f32);
    }

    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32])) {
        source(out);
        self.level.apply(out);
    }
}
