//! Cross-fades between surfaces, and fades at their edges. The fades have equal power, because the
//! textures are uncorrelated. A surface that is not touched is not rendered.

use htex_dsp::glide::Glide;

use super::{Entry, Need, StagePlace};
use crate::file::Effect;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

/// Duration of a cross-fade, seconds: the time in which a 10 mm fingertip moves its own length at 1
/// m/s.
const FADE_S: f64 = 0.010;

pub(crate) const ENTRY: Entry = Entry {
    effect: Effect::Crossfade,
    name: "crossfade",
    place: StagePlace::Surface { need, build: None },
};

fn need(_: &Requirements, played: &PlayedSurface) -> Need {
    if played.always_touched {
        return Need::no("the finger never leaves the surface");
    }
    Need::yes("the finger enters or leaves the surface")
}

/// Fade weight of a surface.
pub(crate) struct Crossfade {
    weight: Glide,
}

impl Crossfade {
    pub(crate) fn new(rate_hz: f64, touched: bool) -> Self {
        let weight = if touched { 1.0 } else { 0.0 };
        Self { weight: Glide::new(weight, (FADE_S * rate_hz).ceil() as u32) }
    }

    pub(crate) fn set(&mut self, touched: bool) {
        self.weight.set(if touched { 1.0 } else { 0.0 });
    }

    /// Whether the surface is neither touched nor fading.
    pub(crate) fn is_silent(&self) -> bool {
        self.weight.rests_at(0.0)
    }

    pub(crate) fn apply(&mut self, block: &mut [f32]) {
        // Most of the time nothing fades, so no square roots are needed.
        if self.weight.rests_at(1.0) {
            return;
        }
        for sample in block {
            *sample *= self.weight.advance().sqrt();
        }
    }
}
