//! Where the finger is, sample by sample: on a smooth curve to where it was told to be.

use htex_model::Motion;

/// Length of the way from one motion to another, seconds.
const BLEND_S: f64 = 0.010;
/// A finger that is told to be further away than this, mm, jumped.
const JUMP_MM: f64 = 0.2;

/// The finger on its path.
pub(crate) struct Path {
    rate_hz: f64,
    /// Samples of a blend.
    blend: f64,
    /// Where it was told to be, mm, and how far it goes a sample.
    told_mm: f64,
    told_step_mm: f64,
    /// Samples since then.
    age: f64,
    /// How far from there it was, mm, and how much further a sample.
    off_mm: f64,
    off_step_mm: f64,
    started: bool,
}

/// What a new motion asks of the voice.
pub(crate) enum Way {
    /// Nothing: the path leads there.
    Smooth,
    /// To be here at once, mm from where it is, before any sample.
    Start(f64),
    /// To fall silent before it is there.
    Jump,
}

impl Path {
    /// At position 0, sliding forward at a speed, mm/s.
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

    /// Takes where the finger is at the next sample.
    pub(crate) fn tell(&mut self, motion: Motion) -> Way {
        let (at_mm, step_mm) = (self.at_mm(0.0), self.at_mm(1.0) - self.at_mm(0.0));
        self.told_mm = motion.position_mm;
        self.told_step_mm = motion.speed_mm_s / self.rate_hz;
        self.age = 0.0;
        self.off_mm = at_mm - self.told_mm;
        self.off_step_mm = step_mm - self.told_step_mm;
        match self.off_mm.abs() <= JUMP_MM {
            _ if !self.started => Way::Start(self.leap()),
            true => Way::Smooth,
            false => Way::Jump,
        }
    }

    /// Changes the speed of a finger that was told no place, mm/s.
    pub(crate) fn set_speed(&mut self, speed_mm_s: f64) {
        let motion = Motion {
            speed_mm_s,
            force_n: 0.0,
            position_mm: self.at_mm(0.0),
        };
        self.tell(motion);
    }

    /// Goes to where the finger was told to be; returns how far that is, mm.
    pub(crate) fn leap(&mut self) -> f64 {
        let before_mm = self.at_mm(0.0);
        (self.off_mm, self.off_step_mm) = (0.0, 0.0);
        self.at_mm(0.0) - before_mm
    }

    /// Goes one sample on; returns how far that is, mm.
    pub(crate) fn advance(&mut self) -> f64 {
        let step_mm = self.at_mm(1.0) - self.at_mm(0.0);
        self.age += 1.0;
        self.started = true;
        step_mm
    }

    /// Position a number of samples on, mm: what is off at first goes to nothing, as its speed does (Hermite's
    /// cubic). A jump is not on the path: it goes on as before.
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
