//! Where a finger is on its path: told, or integrated from its speed.

use htex_host::Motion as ModelMotion;

use crate::Motion;

/// The way of a finger, for models that follow the motion themselves.
#[derive(Debug, Clone)]
pub(crate) struct Travel {
    rate_hz: f64,
    /// Frames since the last motion.
    frames: u64,
    /// The last motion.
    motion: ModelMotion,
    /// Whether a motion was set.
    set: bool,
    /// The last position that was told, mm.
    told_mm: Option<f64>,
}

impl Travel {
    /// At position 0, sliding forward at a speed, mm/s; frames come at `rate_hz`.
    pub(crate) fn new(speed_mm_s: f64, rate_hz: f64) -> Self {
        Self {
            rate_hz,
            frames: 0,
            motion: ModelMotion {
                speed_mm_s,
                force_n: 0.0,
                position_mm: 0.0,
            },
            set: false,
            told_mm: None,
        }
    }

    /// Goes so many frames on.
    pub(crate) fn advance(&mut self, frames: usize) {
        self.frames += frames as u64;
    }

    /// Takes a motion, checked; returns it as models get it if it is new.
    ///
    /// The finger goes back where the position is less than the last one that was told, forward where it is more,
    /// and on where it is the same or not known.
    pub(crate) fn set(&mut self, motion: Motion) -> Option<ModelMotion> {
        let Motion {
            speed_mm_s,
            force_n,
            position_mm,
        } = motion;
        let before = self.motion;
        let same = speed_mm_s == before.speed_mm_s.abs() && force_n == before.force_n;
        if self.set && same && position_mm.is_none() {
            return None;
        }
        let on_mm = before.speed_mm_s * self.frames as f64 / self.rate_hz;
        let back = match position_mm.zip(self.told_mm) {
            Some((now, told)) if now != told => now < told,
            _ => before.speed_mm_s.is_sign_negative(),
        };
        self.motion = ModelMotion {
            speed_mm_s: if back { -speed_mm_s } else { speed_mm_s },
            force_n,
            position_mm: position_mm.unwrap_or(before.position_mm + on_mm),
        };
        self.told_mm = position_mm.or(self.told_mm);
        (self.frames, self.set) = (0, true);
        Some(self.motion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Speed and position of a motion that is new, after which so many frames go by.
    fn told(travel: &mut Travel, at: (f64, Option<f64>), frames: usize) -> Option<(f64, f64)> {
        let motion = travel.set(Motion {
            position_mm: at.1,
            ..Motion::new(at.0, 0.4)
        });
        travel.advance(frames);
        motion.map(|m| (m.speed_mm_s, m.position_mm))
    }

    #[test]
    fn the_position_is_the_way_where_none_is_told() {
        let mut travel = Travel::new(100.0, 1_000.0);
        travel.advance(500);
        let mut told = |speed, frames| told(&mut travel, (speed, None), frames);
        assert_eq!(told(100.0, 250), Some((100.0, 50.0)), "the first is new");
        assert_eq!(told(100.0, 250), None);
        assert_eq!(told(50.0, 1_000), Some((50.0, 100.0)));
        assert_eq!(told(0.0, 1_000), Some((0.0, 150.0)));
        assert_eq!(told(80.0, 0), Some((80.0, 150.0)), "it rested");
        assert!(
            travel.set(Motion::new(80.0, 0.5)).is_some(),
            "another force"
        );
    }

    #[test]
    fn a_position_that_falls_is_the_way_back() {
        let mut travel = Travel::new(0.0, 1_000.0);
        let mut told = |speed, position| told(&mut travel, (speed, position), 10);
        assert_eq!(told(100.0, Some(5.0)), Some((100.0, 5.0)));
        assert_eq!(told(100.0, Some(5.5)), Some((100.0, 5.5)));
        assert_eq!(told(100.0, Some(5.4)), Some((-100.0, 5.4)));
        assert_eq!(told(0.0, Some(5.4)), Some((-0.0, 5.4)));
        assert_eq!(told(100.0, Some(5.4)), Some((-100.0, 5.4)), "it goes on");
        assert_eq!(told(50.0, None), Some((-50.0, 4.4)));
        assert_eq!(told(50.0, Some(6.0)), Some((50.0, 6.0)));
    }
}
