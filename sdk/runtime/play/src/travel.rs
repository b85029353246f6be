//! The position of a finger on its path, given by the host or integrated from the speed.
//!
//! Position and place are the values at the time of the next sample that the *voice* renders
//! ([`crate::SampleSource::follow`]). They are not the values at the time of the source's next
//! sample, because a resampler reads ahead of the voice. The number of samples that the resampler
//! reads ahead differs from call to call, and the resulting jitter would be audible. For a model
//! that does not follow the motion itself, setting a motion costs one test of a `bool`.

use crate::Motion;

/// The direction in which a finger moves over a surface.
#[derive(Debug, Clone, Default)]
pub(crate) struct Course {
    place_mm: Option<[f64; 2]>,
    /// Length 1, or 0 while the direction is unknown.
    direction: [f64; 2],
}

impl Course {
    /// Returns the place of the finger when it has moved by `way_mm` from `place_mm`, in the
    /// direction from the previous place to `place_mm`.
    pub(crate) fn extrapolate(&mut self, place_mm: [f64; 2], way_mm: f64) -> [f64; 2] {
        if let Some(before) = self.place_mm {
            let moved: [f64; 2] = std::array::from_fn(|axis| place_mm[axis] - before[axis]);
            let length = (moved[0] * moved[0] + moved[1] * moved[1]).sqrt();
            if length > 0.0 {
                self.direction = moved.map(|part| part / length);
            }
        }
        self.place_mm = Some(place_mm);
        std::array::from_fn(|axis| place_mm[axis] + way_mm * self.direction[axis])
    }
}

/// The position and direction of a finger, for models that follow the motion themselves.
#[derive(Debug, Clone)]
pub(crate) struct Travel {
    rate_hz: f64,
    /// Frames since the last motion.
    frames: u64,
    /// The last motion. Its speed is negative while the finger moves backward, and its position is
    /// always known.
    motion: Motion,
    /// Whether a motion was set.
    set: bool,
    /// The last given position, mm.
    given_mm: Option<f64>,
}

impl Travel {
    /// Starts at position 0, moving forward at a speed in mm/s, with `rate_hz` frames per second.
    pub(crate) fn new(speed_mm_s: f64, rate_hz: f64) -> Self {
        Self {
            rate_hz,
            frames: 0,
            motion: Motion::new(speed_mm_s, 0.0).with_position_mm(0.0),
            set: false,
            given_mm: None,
        }
    }

    /// Advances by a number of frames.
    pub(crate) fn advance(&mut self, frames: usize) {
        self.frames += frames as u64;
    }

    /// Sets a checked motion. If the motion has changed, returns the motion to pass to the model.
    ///
    /// The finger moves backward if the position is less than the last one given, and forward if it
    /// is greater. If the position is equal or unknown, the direction stays the same. A place
    /// changes neither position nor direction.
    pub(crate) fn set(&mut self, motion: Motion) -> Option<Motion> {
        let Motion { speed_mm_s, force_n, position_mm, place_mm } = motion;
        let before = self.motion;
        let same = speed_mm_s == before.speed_mm_s.abs() && force_n == before.force_n;
        if self.set && same && position_mm.is_none() && place_mm.is_none() {
            return None;
        }
        let on_mm = before.speed_mm_s * self.frames as f64 / self.rate_hz;
        let back = match position_mm.zip(self.given_mm) {
            Some((now, before)) if now != before => now < before,
            // The sign of zero counts: a resting finger that moved backward has a speed of -0.
            _ => before.speed_mm_s.is_sign_negative(),
        };
        let reached_mm = before.position_mm.unwrap_or_default() + on_mm;
        self.motion = Motion {
            speed_mm_s: if back { -speed_mm_s } else { speed_mm_s },
            position_mm: Some(position_mm.unwrap_or(reached_mm)),
            ..motion
        };
        self.given_mm = position_mm.or(self.given_mm);
        (self.frames, self.set) = (0, true);
        Some(self.motion)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failed test may panic")]
mod tests {
    use super::*;

    /// Sets a motion and advances; returns speed and position if the motion has changed.
    fn set(travel: &mut Travel, at: (f64, Option<f64>), frames: usize) -> Option<(f64, f64)> {
        let motion = travel.set(Motion { position_mm: at.1, ..Motion::new(at.0, 0.4) });
        travel.advance(frames);
        motion.map(|m| (m.speed_mm_s, m.position_mm.unwrap()))
    }

    #[test]
    fn an_unknown_position_is_integrated_from_the_speed() {
        let mut travel = Travel::new(100.0, 1_000.0);
        travel.advance(500);
        let mut set = |speed, frames| set(&mut travel, (speed, None), frames);
        assert_eq!(set(100.0, 250), Some((100.0, 50.0)), "the first motion");
        assert_eq!(set(100.0, 250), None);
        assert_eq!(set(50.0, 1_000), Some((50.0, 100.0)));
        assert_eq!(set(0.0, 1_000), Some((0.0, 150.0)));
        assert_eq!(set(80.0, 0), Some((80.0, 150.0)), "the position was constant at 0 mm/s");
        assert!(travel.set(Motion::new(80.0, 0.5)).is_some(), "another force");
    }

    #[test]
    fn a_decreasing_position_is_a_negative_speed() {
        let mut travel = Travel::new(0.0, 1_000.0);
        let mut set = |speed, position| set(&mut travel, (speed, position), 10);
        assert_eq!(set(100.0, Some(5.0)), Some((100.0, 5.0)));
        assert_eq!(set(100.0, Some(5.5)), Some((100.0, 5.5)));
        assert_eq!(set(100.0, Some(5.4)), Some((-100.0, 5.4)));
        assert_eq!(set(0.0, Some(5.4)), Some((-0.0, 5.4)));
        assert_eq!(set(100.0, Some(5.4)), Some((-100.0, 5.4)), "the direction is kept");
        assert_eq!(set(50.0, None), Some((-50.0, 4.4)));
        assert_eq!(set(50.0, Some(6.0)), Some((50.0, 6.0)));
    }
}
