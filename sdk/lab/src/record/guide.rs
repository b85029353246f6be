//! Guidance for the user during a recording. It shows the motion of the target, the position of the
//! user's finger, and whether the force is right. It also drives a metronome.

use serde::Serialize;

/// The target of a recording, as the screen shows it.
///
/// On the screen, the target is a square that moves back and forth over a stroke at the target
/// speed. The metronome beats each time the target turns. The target already moves before the take
/// begins, so that the finger can follow it from the start.
///
/// ```
/// use htex_lab::record::{Force, Guidance};
///
/// let guidance = Guidance { speed_mm_s: Some(80.0), force_n: Some(0.4), tolerance: 0.1, stroke_mm: 80.0 };
/// // There in a second, and half of the way back.
/// assert_eq!([0.0, 0.5, 1.0, 1.5].map(|t| guidance.target_mm(t).unwrap_or(0.0)), [0.0, 40.0, 80.0, 40.0]);
/// // In a countdown times are negative, and the target comes to its beginning.
/// assert_eq!([-0.5, -0.25].map(|t| guidance.target_mm(t).unwrap_or(0.0)), [40.0, 20.0]);
/// assert_eq!([-0.1, 0.0, 0.9, 2.5].map(|t| guidance.turns(t)), [Some(-1), Some(0), Some(0), Some(2)]);
/// assert_eq!([0.3, 0.37, 0.5].map(|n| guidance.force(Some(n))), [Force::Below, Force::Within, Force::Above]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guidance {
    /// Target speed, mm/s.
    pub speed_mm_s: Option<f64>,
    /// Target normal force, newtons.
    pub force_n: Option<f64>,
    /// Allowed relative difference of the force.
    pub tolerance: f64,
    /// Length of a stroke, millimetres.
    pub stroke_mm: f64,
}

/// How the normal force compares with its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Force {
    /// There is no target, or the force is not measured.
    Unknown,
    /// The force is below the target's range; the paper (`docs/paper.md`) shows this state in
    /// yellow.
    Below,
    /// The force is in the target's range; the paper shows this state in green.
    Within,
    /// The force is above the target's range; the paper shows this state in red.
    Above,
}

/// What a session is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The user lifts the finger, so that the forces can be measured without it (tare).
    Lift,
    /// The forces are measured without a finger (tare).
    Tare,
    /// A take is about to begin.
    Countdown,
    /// A take is being recorded.
    Take,
}

/// The state of a session, updated about 50 times a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment<'a> {
    pub phase: Phase,
    /// Number of the take.
    pub number: u32,
    /// Seconds since the phase began.
    pub elapsed_s: f64,
    /// Length of the phase, seconds.
    pub of_s: f64,
    /// Normal force, newtons: the absolute value of the mean over the last 50 ms. The judgement of
    /// a take also uses means over 50 ms.
    pub force_n: Option<f64>,
    /// Position of the finger along the axis on which the finger moves most, mm, measured from the
    /// lowest position so far.
    pub position_mm: Option<f64>,
    /// Samples since the previous moment, for each axis of the texture's signal, in the signal's
    /// unit.
    pub texture: &'a [&'a [f64]],
}

impl Phase {
    /// Returns the name that the page uses.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Lift => "lift",
            Self::Tare => "tare",
            Self::Countdown => "countdown",
            Self::Take => "take",
        }
    }

    /// Returns the time since the start of the take, seconds. It is negative during the countdown.
    /// Returns `None` in phases in which the target does not move.
    #[must_use]
    pub fn motion_s(self, elapsed_s: f64, of_s: f64) -> Option<f64> {
        match self {
            Self::Lift | Self::Tare => None,
            Self::Countdown => Some(elapsed_s - of_s),
            Self::Take => Some(elapsed_s),
        }
    }
}

impl Guidance {
    /// Returns the target's position at a time, mm, or `None` without a target speed. The target is
    /// at 0 mm at 0 s. Its motion before 0 s mirrors its motion after 0 s, so that the countdown
    /// leads smoothly into the take.
    #[must_use]
    pub fn target_mm(&self, at_s: f64) -> Option<f64> {
        let way_mm = self.speed_mm_s? * at_s.abs();
        let into_mm = libm::fmod(way_mm, 2.0 * self.stroke_mm);
        Some(into_mm.min(2.0 * self.stroke_mm - into_mm))
    }

    /// Returns how many times the target turns from 0 s to the given time, or `None` without a
    /// target speed. The number is negative before 0 s. The metronome beats at each turn.
    #[must_use]
    pub fn turns(&self, at_s: f64) -> Option<i64> {
        Some((self.speed_mm_s? * at_s / self.stroke_mm).floor() as i64)
    }

    /// Returns the range of forces within the tolerance, newtons.
    pub(crate) fn force_range_n(&self) -> Option<[f64; 2]> {
        let target_n = self.force_n?;
        let range_n = self.tolerance * target_n;
        Some([target_n - range_n, target_n + range_n])
    }

    /// Compares a normal force with its target.
    #[must_use]
    pub fn force(&self, force_n: Option<f64>) -> Force {
        let (Some(force_n), Some([low_n, high_n])) = (force_n, self.force_range_n()) else {
            return Force::Unknown;
        };
        match force_n {
            n if n < low_n => Force::Below,
            n if n > high_n => Force::Above,
            _ => Force::Within,
        }
    }
}

/// The path of a finger so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct FingerPath {
    /// Lowest, highest and newest position along each axis, mm.
    axes: [Option<[f64; 3]>; 2],
}

impl FingerPath {
    /// Updates the path with a position along an axis, mm.
    pub(crate) fn see(&mut self, axis: usize, at_mm: f64) {
        let [low, high, _] = self.axes[axis].unwrap_or([at_mm; 3]);
        self.axes[axis] = Some([low.min(at_mm), high.max(at_mm), at_mm]);
    }

    /// Returns the newest position on the axis with the longer path, mm from its lowest position.
    pub(crate) fn place_mm(&self) -> Option<f64> {
        let way = |axis: &&[f64; 3]| axis[1] - axis[0];
        let seen = self.axes.iter().flatten();
        let longest = seen.max_by(|a, b| way(a).total_cmp(&way(b)))?;
        Some(longest[2] - longest[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_is_on_the_axis_that_moves() {
        let mut path = FingerPath::default();
        assert_eq!(path.place_mm(), None);
        for (x, y) in [(1.0, -40.0), (1.5, -10.0), (1.2, 20.0), (1.0, 5.0)] {
            path.see(0, x);
            path.see(1, y);
        }
        assert_eq!(path.place_mm(), Some(45.0));
    }
}
