//! The finger's place at each sample, on a smooth curve to the places that the host sets.

use htex_model::Motion;

/// Duration of the transition from one motion to another, seconds.
const BLEND_S: f64 = 0.010;
/// Distance between a new place and the current one, mm, above which the finger has jumped.
const JUMP_MM: f64 = 1.0;
/// Distance between a new place and the expected one, mm, below which they count as equal.
const EXPECTED_MM: f64 = 1e-6;
/// If two places are farther apart in time than this, in blends, they do not determine a direction.
const FORGOTTEN: f64 = 10.0;

/// The finger on the surface: x and y in mm.
pub(crate) struct Path {
    /// Number of samples in a blend.
    blend: f64,
    rate_hz: f64,
    at: [f64; 2],
    /// Movement per sample, mm.
    step: [f64; 2],
    /// Distance to the place that was set, mm, and the number of samples in which the rest of it is
    /// covered.
    off: [f64; 2],
    off_left: f64,
    /// The last place that was set, and the number of samples since then.
    told: Option<[f64; 2]>,
    age: f64,
}

/// What a voice has to do when a new motion is set.
#[derive(PartialEq)]
pub(crate) enum Transition {
    /// Start at the place.
    Start,
    /// Nothing: the path reaches the place smoothly.
    Smooth,
    /// Fade out before jumping to the place.
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

    /// Number of samples in a blend.
    pub(crate) fn blend(&self) -> f64 {
        self.blend
    }

    /// Sets the place `ahead` samples before the next one, and the speed from there on. The
    /// direction is the one in which the place has moved; if that is unknown, it is along x.
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
        // If the place is the expected one, the way to it stays unchanged.
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

    /// Moves at once to the place that was set, advanced by the time since then.
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
