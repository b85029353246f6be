//! Converts levels and mean frequencies to the input of motors and parametric haptic interfaces. A
//! level becomes a strength from 0 to 1. A mean frequency becomes its place in a range of
//! frequencies, from 0 to 1. A point combines a time, a strength and a place.
//!
//! A parametric interface interpolates linearly between points. Each block of samples gives one
//! point, at the end of the block, with the block's level. So the interface reaches the level of a
//! block when the block ends. On average, its output is half a block later than the output of an
//! interface that holds each level during its block.

use crate::envelope::Measurement;

/// Highest mean frequency at which the large motor of a gamepad gets the whole strength, hertz.
const LARGE_MOTOR_HZ: f64 = 60.0;
/// Lowest mean frequency at which the small motor gets the whole strength, hertz.
const SMALL_MOTOR_HZ: f64 = 420.0;

/// Converts a level to a strength, and a mean frequency to a place in a range of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Strength for a level of 1. Strengths above 1 are limited to 1.
    pub gain: f64,
    /// Frequency at place 0, hertz.
    pub low_hz: f64,
    /// Frequency at place 1, hertz.
    pub high_hz: f64,
}

impl Scale {
    /// Returns the strength for a level, 0 to 1.
    pub fn strength(&self, level_rms: f64) -> f64 {
        unit(self.gain * level_rms)
    }

    /// Returns the place of a frequency in the range, 0 to 1; 0.5 if the range is empty.
    pub fn place(&self, hz: f64) -> f64 {
        if self.high_hz > self.low_hz {
            unit((hz - self.low_hz) / (self.high_hz - self.low_hz))
        } else {
            0.5
        }
    }
}

/// Clamps a number to 0 to 1; NaN becomes 0.
fn unit(x: f64) -> f64 {
    if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }
}

/// Divides a strength between the large and the small motor of a gamepad, depending on the mean
/// frequency. At 60 Hz and below, the large motor gets the whole strength. At 420 Hz and above, the
/// small motor gets the whole strength. Between these frequencies the two parts change linearly
/// with the frequency.
///
/// ```
/// use htex_dsp::reduced::two_motors;
/// assert_eq!(two_motors(0.5, 240.0), [0.25, 0.25]);
/// ```
pub fn two_motors(strength: f64, centroid_hz: f64) -> [f64; 2] {
    let small = unit((centroid_hz - LARGE_MOTOR_HZ) / (SMALL_MOTOR_HZ - LARGE_MOTOR_HZ));
    [strength * (1.0 - small), strength * small]
}

/// A point of the stream for a haptic interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Time since the start of the stream, nanoseconds.
    pub time_ns: i64,
    /// Strength, 0 to 1.
    pub strength: f32,
    /// Position of the mean frequency between the lowest frequency of the scale (0) and its highest
    /// frequency (1).
    pub place: f32,
}

/// Converts blocks to a stream of points.
///
/// ```
/// use htex_dsp::envelope::Measurement;
/// use htex_dsp::reduced::{Points, Scale};
/// let scale = Scale { gain: 1.0, low_hz: 0.0, high_hz: 500.0 };
/// let mut points = Points::default();
/// let block = Measurement { level_rms: 0.5, centroid_hz: 250.0, frames: 80 };
/// let made: Vec<_> = points.block(&block, &scale, 8_000.0).collect();
/// assert_eq!(made.iter().map(|p| p.time_ns).collect::<Vec<_>>(), [0, 10_000_000]);
/// assert_eq!(made[1].strength, 0.5);
/// assert_eq!(points.block(&block, &scale, 8_000.0).count(), 1);
/// assert_eq!(points.end(8_000.0).strength, 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Points {
    /// Number of samples so far.
    pub frames: u64,
    /// Place of the last point. Silence has no frequency, so the place stays unchanged during
    /// silence.
    pub place: f32,
}

impl Points {
    /// Returns the points for the next block. Each block has one point at its end, and the first
    /// block also has a point at time 0.
    pub fn block(
        &mut self,
        measured: &Measurement,
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

    /// Returns the point that ends the stream: silence, at the end of the last block.
    pub fn end(&self, rate_hz: f64) -> Point {
        Point {
            // The time is computed from the number of all samples, so that the rounding errors of
            // the blocks do not add up.
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
        /// For any measured values, the points meet the requirements of interfaces: numbers from 0
        /// to 1, in order of time.
        #[test]
        fn points_are_in_range_and_in_order(
            blocks in prop::collection::vec((any::<f64>(), any::<f64>(), 0..1_000_u64), 1..50),
            gain in any::<f64>(), low_hz in any::<f64>(), high_hz in any::<f64>(), rate_hz in 1e3..1e5,
        ) {
            let scale = Scale { gain, low_hz, high_hz };
            let mut points = Points::default();
            let mut last_ns = 0;
            for (level_rms, centroid_hz, frames) in blocks {
                let measured = Measurement { level_rms, centroid_hz, frames };
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
