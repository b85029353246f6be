//! Computes the finger's place at each sample, on a smooth curve through the places that the host
//! sets.

use htex_model::Motion;

/// Duration of the transition from one motion to another, seconds.
const BLEND_S: f64 = 0.010;
/// If a new place is farther than this from the current place, mm, the finger has jumped.
const JUMP_MM: f64 = 1.0;
/// If a new place is nearer than this to the expected place, mm, the places count as equal.
const EXPECTED_MM: f64 = 1e-6;
/// If two places are set farther apart in time than this number of blends, they do not determine a
/// direction.
const FORGOTTEN: f64 = 10.0;

/// The finger on the surface: x and y in mm.
pub(crate) struct Path {
    /// Number of samples in a blend, i.e. in the transition to another motion.
    blend: f64,
    rate_hz: f64,
    at: [f64; 2],
    /// Movement per sample, mm.
    step: [f64; 2],
    /// Distance to the place that was set, mm, and the number of samples in which the path covers
    /// the rest of this distance.
    off: [f64; 2],
    off_left: f64,
    /// The last place that was set, and the number of samples since then.
    told: Option<[f64; 2]>,
    age: f64,
}

/// What a voice has to do when a new motion is set.
#[derive(PartialEq)]
pub(crate) enum Transition {
    /// Start the path at the new place.
    Start,
    /// Do nothing, because the path reaches the new place smoothly.
    Smooth,
    /// Fade out before jumping to the new place.
    Jump,
}

impl Path {
    /// Makes a path for a finger whose place is needed `rate_hz` times per second.
    pub(crate) fn new(rate_hz: f64) -> Self {
        Self {
            blend: libm::ceil(BLEND_S * rate_hz),
            rate_hz,
            at: [0.0; 2],
            step: [0.0; 2],
            off: [0.0; 2],
            off_left: 0.0,
            told: None,
            age: 0.0,
        }
    }

    /// Returns the number of samples in a blend.
    pub(crate) fn blend(&self) -> f64 {
        self.blend
    }

    /// Sets the finger's place at the sample that is `ahead` samples before the next sample, and
    /// the speed from there on. The direction is the direction from the previous place to this one.
    /// If it is unknown, the finger moves along x.
    pub(crate) fn tell(&mut self, motion: Motion, ahead: f64) -> Transition {
        let place = [motion.x_mm, motion.y_mm];
        let per_sample = motion.speed_mm_s.abs() / self.rate_hz;
        let moved = self.told.map(|told| [place[0] - told[0], place[1] - told[1]]);
        let length = moved.map_or(0.0, |[x, y]| libm::sqrt(x * x + y * y));
        let is_known = length > 0.0 && self.age <= FORGOTTEN * self.blend;
        self.step = match moved {
            Some([x, y]) if is_known => [per_sample * x / length, per_sample * y / length],
            Some(_) if length == 0.0 && self.speed() > 0.0 => {
                let factor = per_sample / self.speed();
                self.step.map(|step| factor * step)
            }
            _ => [motion.speed_mm_s / self.rate_hz, 0.0],
        };
        let is_first = self.told.is_none();
        self.told = Some(place);
        self.age = ahead;
        let now = self.now(place);
        let off = [now[0] - self.at[0], now[1] - self.at[1]];
        if is_first {
            self.at = now;
            return Transition::Start;
        }
        // If the finger is at the expected place, its path stays unchanged.
        let left = self.off_left.max(0.0) / self.blend;
        let is_expected = |axis: usize| (off[axis] - left * self.off[axis]).abs() < EXPECTED_MM;
        if is_expected(0) && is_expected(1) {
            return Transition::Smooth;
        }
        if off[0].abs() > JUMP_MM || off[1].abs() > JUMP_MM {
            return Transition::Jump;
        }
        self.off = off;
        self.off_left = self.blend;
        Transition::Smooth
    }

    fn speed(&self) -> f64 {
        libm::sqrt(self.step[0] * self.step[0] + self.step[1] * self.step[1])
    }

    /// Moves at once to the place that was set, plus the movement since then.
    pub(crate) fn leap(&mut self) {
        if let Some(told) = self.told {
            self.at = self.now(told);
            self.off_left = 0.0;
        }
    }

    /// Returns the place at the next sample, if the finger was at `told` when the place was set.
    fn now(&self, told: [f64; 2]) -> [f64; 2] {
        core::array::from_fn(|axis| told[axis] + self.age * self.step[axis])
    }

    /// Returns the current place, mm, and advances by one sample.
    pub(crate) fn next(&mut self) -> [f64; 2] {
        let at = self.at;
        self.age += 1.0;
        for axis in 0..2 {
            self.at[axis] += self.step[axis];
            if self.off_left > 0.0 {
                self.at[axis] += self.off[axis] / self.blend;
            }
        }
        self.off_left -= 1.0;
        at
    }
}
