//! A voice that follows the finger itself, by the extension `htex.motion/1`: a host then scales neither
//! frequencies with the speed nor the level with the force.
//!
//! To begin with, the faster the finger, the stronger the texture, as it was recorded at 100 mm/s. The position is where
//! a model comes in that is tied to the place; [`FitInput::condition`](htex_model::FitInput) tells a fit at which speed
//! and force the recording was made.

use htex_model::{Error, Motion, MotionVoice, Values, Voice};
use htex_shaped::ShapedVoice;

use crate::Shape;

/// Shaped noise whose level goes with the speed.
pub struct Following {
    noise: ShapedVoice<Shape>,
    level: f32,
    goal: f32,
    /// Part of the way to the goal that is made with each sample: nearly all in 10 ms.
    part: f32,
}

impl Following {
    pub(crate) fn new(noise: ShapedVoice<Shape>, rate_hz: f64) -> Self {
        Self {
            noise,
            level: 1.0,
            goal: 1.0,
            part: (300.0 / rate_hz).min(1.0) as f32,
        }
    }
}

impl Voice for Following {
    fn render(&mut self, out: &mut [f32]) {
        self.noise.render(out);
        for x in out {
            self.level += (self.goal - self.level) * self.part;
            *x *= self.level;
            // No processor meets slow subnormal numbers.
            if x.abs() < f32::MIN_POSITIVE {
                *x = 0.0;
            }
        }
        if self.level < 1e-20 {
            self.level = 0.0;
        }
    }

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        self.noise.retune(parameters)
    }
}

impl MotionVoice for Following {
    fn set_motion(&mut self, motion: Motion) {
        self.goal = (motion.speed_mm_s.abs() / 100.0).min(4.0) as f32;
    }
}
