//! The finger's position at each sample, on a smooth curve to the positions that were set.

use htex_model::Motion;

/// Duration of the transition from one motion to another, seconds.
const BLEND_S: f64 = 0.010;
/// If a new position is farther than this from the current position, mm, the finger has jumped.
const JUMP_MM: f64 = 0.2;

/// The finger on its path.
pub(crate) struct Path {
    rate_hz: f64,
    /// Samples of a blend.
    blend: f64,
    /// The position that was set, mm, and the distance per sample.
    told_mm: f64,
    told_step_mm: f64,
    /// Samples since then.
    age: f64,
    /// Difference between the path and the set position at that time, mm, and the change of this
    /// difference per sample.
    off_mm: f64,
    off_step_mm: f64,
    started: bool,
}

/// The reaction of the voice to a new motion.
pub(crate) enum Way {
    /// Do nothing, because the path reaches the new position smoothly.
    Smooth,
    /// Move by this distance, mm, before the first sample.
    Start(f64),
    /// Fade out before the jump.
    Jump,
}

impl Path {
    /// Starts at position 0, moving forward at a speed, mm/s.
    pub(crate) fn new(speed_mm_s: f64, rate_hz: f64) -> Self {
        Self {
            rate_hz,
            blend: libm::ceil(BLEND_S * rate_hz),
            told_mm: 0.0,
            told_step_mm: speed_mm_s / rate_hz,
            age: 0.0,
            off_mm: 0.0,
            off_step_mm: 0.0,
            started: false,
        }
    }

    /// Samples of a blend.
    pub(crate) fn blend(&self) -> f64 {
        self.blend
    }

    /// Sets the finger's position at the next sample.
    pub(crate) fn tell(&mut self, motion: Motion) -> Way {
        let (at_mm, step_mm) = (self.at_mm(0.0), self.at_mm(1.0) - self.at_mm(0.0));
        self.told_mm = motion.position_mm;
        self.told_step_mm = motion.speed_mm_s / self.rate_hz;
        self.age = 0.0;
        self.off_mm = at_mm - self.told_mm;
        self.off_step_mm = step_mm - self.told_step_mm;
        if !self.started {
            Way::Start(self.leap())
        } else if self.off_mm.abs() <= JUMP_MM {
            Way::Smooth
        } else {
            Way::Jump
        }
    }

    /// Sets the speed of a finger whose position is unknown, mm/s.
    pub(crate) fn set_speed(&mut self, speed_mm_s: f64) {
        let motion = Motion {
            speed_mm_s,
            force_n: 0.0,
            position_mm: self.at_mm(0.0),
            x_mm: 0.0,
            y_mm: 0.0,
        };
        self.tell(motion);
    }

    /// Moves to the position that was set; returns the distance, mm.
    pub(crate) fn leap(&mut self) -> f64 {
        let before_mm = self.at_mm(0.0);
        (self.off_mm, self.off_step_mm) = (0.0, 0.0);
        self.at_mm(0.0) - before_mm
    }

    /// Advances by one sample; returns the distance, mm.
    pub(crate) fn advance(&mut self) -> f64 {
        let step_mm = self.at_mm(1.0) - self.at_mm(0.0);
        self.age += 1.0;
        self.started = true;
        step_mm
    }

    /// Position after a number of samples, mm: the initial differences in position and speed
    /// decrease to 0 along a cubic Hermite curve. The path does not contain jumps: before a jump,
    /// it continues at its old speed.
    fn at_mm(&self, samples: f64) -> f64 {
        let n = self.age + samples;
        let told_mm = self.told_mm + n * self.told_step_mm;
        if self.off_mm.abs() > JUMP_MM {
            return told_mm + self.off_mm + n * self.off_step_mm;
        }
        let u = (n / self.blend).min(1.0);
        let rest = (1.0 - u) * (1.0 - u);
        told_mm + self.off_mm * rest * (1.0 + 2.0 * u) + self.off_step_mm * self.blend * rest * u
    }
}
