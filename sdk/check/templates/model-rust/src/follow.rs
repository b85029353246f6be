//! A voice that receives the finger's motion through the extension `htex.motion/1`. Such a voice
//! must change its sound with speed and force itself, because the host does not scale its
//! frequencies and level.
//!
//! In this template the level is proportional to the speed, and 1 at 100 mm/s. A model may also use
//! the position, for example for a pattern that is fixed to the surface. While the model is fitted,
//! [`FitInput::condition`](htex_model::FitInput) contains the speed and force of the recording.

use htex_model::shaped::ShapedVoice;
use htex_model::{Error, Motion, MotionVoice, Values, Voice};

use crate::Shape;

/// Shaped noise whose level is proportional to the speed.
pub struct Following {
    noise: ShapedVoice<Shape>,
    level: f32,
    goal: f32,
    /// Fraction of the remaining difference to the target that each sample adds: nearly all of it
    /// in 10 ms.
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
            // Avoids subnormal numbers, which are slow on some processors.
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
