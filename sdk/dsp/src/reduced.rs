//! Level and mean frequency as motors and parametric interfaces take them: strengths, frequencies
//! and points from 0 to 1.
//!
//! An interface that is told in points interpolates linearly between them. A block has one point,
//! at its end, with its level: the level of a block is then reached when the block ends, half a
//! block later on average than with steps.

use crate::envelope::Measured;

/// Mean frequency up to which the large motor of a gamepad has all of the strength, hertz.
const LARGE_MOTOR_HZ: f64 = 60.0;
/// Mean frequency from which the small motor has all of it, hertz.
const SMALL_MOTOR_HZ: f64 = 420.0;

/// How a level becomes a strength, and a mean frequency a share of a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Strength of a level of 1; more than 1 is 1.
    pub gain: f64,
    /// Frequency that is 0, hertz.
    pub low_hz: f64,
    /// Frequency that is 1, hertz.
    pub high_hz: f64,
}

impl Scale {
    /// Returns the strength of a level, 0 to 1.
    pub fn strength(&self, level_rms: f64) -> f64 {
        unit(self.gain * level_rms)
    }

    /// Returns the place of a frequency in the range, 0 to 1; 0.5 in an empty range.
    pub fn place(&self, hz: f64) -> f64 {
        if self.high_hz > self.low_hz {
            unit((hz - self.low_hz) / (self.high_hz - self.low_hz))
        } else {
            0.5
        }
    }
}

/// Returns a number from 0 to 1; 0 for what is none.
fn unit(x: f64) -> f64 {
    if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }
}

/// Returns the parts of a strength that the large and the small motor of a gamepad have at a mean
/// frequency: all on the large one up to 60 Hz, all on the small one from 420 Hz, in between in
/// proportion.
///
/// ```
/// use htex_dsp::reduced::two_motors;
/// assert_eq!(two_motors(0.5, 240.0), [0.25, 0.25]);
/// ```
pub fn two_motors(strength: f64, centroid_hz: f64) -> [f64; 2] {
    let small = unit((centroid_hz - LARGE_MOTOR_HZ) / (SMALL_MOTOR_HZ - LARGE_MOTOR_HZ));
    [strength * (1.0 - small), strength * small]
}

/// A point of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Time since the start of the stream, nanoseconds.
    pub time_ns: i64,
    /// Strength, 0 to 1.
    pub strength: f32,
    /// Mean frequency, as a place in the range of the scale.
    pub place: f32,
}

/// Makes a stream of points out of blocks.
///
/// ```
/// use htex_dsp::envelope::Measured;
/// use htex_dsp::reduced::{Points, Scale};
/// let scale = Scale { gain: 1.0, low_hz: 0.0, high_hz: 500.0 };
/// let mut points = Points::default();
/// let block = Measured { level_rms: 0.5, centroid_hz: 250.0, frames: 80 };
/// let made: Vec<_> = points.block(&block, &scale, 8_000.0).collect();
/// assert_eq!(made.iter().map(|p| p.time_ns).collect::<Vec<_>>(), [0, 10_000_000]);
/// assert_eq!(made[1].strength, 0.5);
/// assert_eq!(points.block(&block, &scale, 8_000.0).count(), 1);
/// assert_eq!(points.end(8_000.0).strength, 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Points {
    /// Samples so far.
    pub frames: u64,
    /// The last place: silence has no frequency and keeps it.
    pub place: f32,
}

impl Points {
    /// Returns the points of the next block: one at its end, and before the first one at 0.
    pub fn block(
        &mut self,
        measured: &Measured,
        scale: &Scale,
        rate_hz: f64,
    ) -> impl Iterator<Item = Point> + use<> {
        let is_first = self.frames == 0;
        self.frames += measured.frames;
        if measured.centroid_hz > 0.0 {
            self.place = scale.place(measured.centroid_hz) as f32;
        }
        let point =
            Point { strength: scale.strength(measured.level_rms) as f32, ..self.end(rate_hz) };
        let first = is_first.then_some(Point { time_ns: 0, ..point });
        first.into_iter().chain(Some(point))
    }

    /// Returns the point that ends the stream: silence where the last block ended.
    pub fn end(&self, rate_hz: f64) -> Point {
        Point {
            time_ns: libm::round(self.frames as f64 / rate_hz * 1e9) as i64,
            strength: 0.0,
            place: self.place,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever is measured, the points keep what takers of points ask for: numbers from 0 to
        /// 1, in the order of time.
        #[test]
        fn points_are_in_range_and_in_order(
            blocks in prop::collection::vec((any::<f64>(), any::<f64>(), 0..1_000_u64), 1..50),
            gain in any::<f64>(), low_hz in any::<f64>(), high_hz in any::<f64>(), rate_hz in 1e3..1e5,
        ) {
            let scale = Scale { gain, low_hz, high_hz };
            let mut points = Points::default();
            let mut last_ns = 0;
            for (level_rms, centroid_hz, frames) in blocks {
                let measured = Measured { level_rms, centroid_hz, frames };
                for point in points.block(&measured, &scale, rate_hz) {
                    prop_assert!((0.0..=1.0).contains(&point.strength) && (0.0..=1.0).contains(&point.place));
                    prop_assert!(point.time_ns >= last_ns);
                    last_ns = point.time_ns;
                }
            }
            let motors = two_motors(scale.strength(gain), low_hz);
            prop_assert!(motors.iter().all(|part| (0.0..=1.0).contains(part)));
        }
    }
}
