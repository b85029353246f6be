//! A recorded motion (trace), which can be interpolated at any time.
//!
//! The speed is computed from an averaged velocity: the second difference of the integral of the
//! position ([`velocity`]). The speed of a steady motion is exact, even if the rows are not evenly
//! spaced. The steps of a 60 Hz tracker have little influence on the result.

use std::path::Path;

use htex_play::exploration::{HOLD_S, MOST_FORCE_N, MOST_SPEED_MM_S};
use htex_recording::velocity;
use htex_recording::{ReadError, TraceColumns, read_trace, trace_from_bytes};

/// Tolerance of times, seconds. Rows of a trace are at least this far apart.
const ROUNDING_S: f64 = 1e-9;

/// A motion over time. All vectors have the same length, at least 2. Time 0 is the first row.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Time, seconds, strictly ascending from 0.
    pub t_s: Vec<f64>,
    /// Position along x, mm.
    pub x_mm: Vec<f64>,
    /// Position along y, mm.
    pub y_mm: Vec<f64>,
    /// Normal force, newtons, not negative.
    pub force_n: Vec<f64>,
    /// Sliding speed, mm/s, not negative. If the trace has a speed column, the speeds are taken
    /// from this column. Otherwise they are computed from the velocity.
    pub speed_mm_s: Vec<f64>,
    /// Velocity along x and y, mm/s, computed from the positions.
    pub velocity_mm_s: Vec<[f64; 2]>,
    /// Warnings of the reader, such as assumed units.
    pub warnings: Vec<String>,
}

/// The motion at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TracePoint {
    /// Position along x, mm.
    pub x_mm: f64,
    /// Position along y, mm.
    pub y_mm: f64,
    /// Sliding speed, mm/s, not negative.
    pub speed_mm_s: f64,
    /// Normal force, newtons, not negative.
    pub force_n: f64,
    /// Velocity along x, mm/s.
    pub vx_mm_s: f64,
    /// Velocity along y, mm/s.
    pub vy_mm_s: f64,
}

impl Trace {
    /// Reads a trace from a CSV file with the columns `t_s`, `x_mm`, `y_mm`, `force_n` and
    /// optionally `speed_mm_s`.
    ///
    /// # Errors
    /// Returns the same errors as [`read_trace`].
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Ok(Self::new(read_trace(path)?))
    }

    /// Reads a trace as [`Self::open`] does, but from a file in memory. Messages name `file`.
    ///
    /// # Errors
    /// Returns the same errors as [`read_trace`].
    pub fn from_bytes(file: &str, bytes: &[u8]) -> Result<Self, ReadError> {
        Ok(Self::new(trace_from_bytes(file, bytes)?))
    }

    /// Makes a trace from columns.
    ///
    /// [`velocity`] computes the velocity. A constant velocity is computed exactly, and the steps
    /// of a 60 Hz tracker have little influence. Negative forces, which an offset of the sensor can
    /// cause, become 0.
    ///
    /// Impossible rows (above 1000 mm/s or 20 N) are replaced by the last valid row for at most 100
    /// ms. After these 100 ms, impossible rows become rows without contact. Impossible rows are
    /// replaced before interpolation, because a value interpolated between a valid and an
    /// impossible row may look valid.
    pub fn new(columns: TraceColumns) -> Self {
        let start_s = columns.t_s.first().copied().unwrap_or(0.0);
        let t_s: Vec<f64> = columns.t_s.iter().map(|t| t - start_s).collect();
        let along = |position: &[f64]| velocity(&t_s, position, t_s.iter().copied());
        let (vx, vy) = (along(&columns.x_mm), along(&columns.y_mm));
        let velocity_mm_s: Vec<[f64; 2]> = vx.iter().zip(vy).map(|(x, y)| [*x, y]).collect();
        let moved: Vec<f64> = velocity_mm_s.iter().map(|[x, y]| libm::hypot(*x, *y)).collect();
        let speed_mm_s = match columns.speed_mm_s {
            Some(speed) => speed.iter().map(|v| v.abs()).collect(),
            None => moved.clone(),
        };
        let force_n: Vec<f64> = columns.force_n.iter().map(|f| f.max(0.0)).collect();
        let good = readings(&t_s, |row| {
            speed_mm_s[row] <= MOST_SPEED_MM_S && force_n[row] <= MOST_FORCE_N
        });
        // The velocity is checked separately, because a recorded speed may be valid where the
        // positions jump.
        let steady = readings(&t_s, |row| moved[row] <= MOST_SPEED_MM_S);
        Self {
            t_s,
            x_mm: columns.x_mm,
            y_mm: columns.y_mm,
            force_n: taken(&good, &force_n),
            speed_mm_s: taken(&good, &speed_mm_s),
            velocity_mm_s: taken(&steady, &velocity_mm_s),
            warnings: columns.warnings,
        }
    }

    /// Returns the motion at `t_s` seconds, interpolated linearly between rows. Before the first
    /// row and after the last row, the finger rests at the position of that row without contact:
    /// speed and force are 0. Does not allocate.
    pub fn point_at(&self, t_s: f64) -> TracePoint {
        let last = self.t_s.len().saturating_sub(1);
        let above = self.t_s.partition_point(|t| *t <= t_s);
        if above == 0 || t_s > self.duration_s() || t_s.is_nan() {
            return self.resting(if above == 0 { 0 } else { last });
        }
        let (low, high) = (above - 1, above.min(last));
        let weight = if low == high {
            0.0
        } else {
            (t_s - self.t_s[low]) / (self.t_s[high] - self.t_s[low])
        };
        let between = |a: f64, b: f64| a + weight * (b - a);
        let of = |values: &[f64]| between(values[low], values[high]);
        let (v0, v1) = (self.velocity_mm_s[low], self.velocity_mm_s[high]);
        TracePoint {
            x_mm: of(&self.x_mm),
            y_mm: of(&self.y_mm),
            speed_mm_s: of(&self.speed_mm_s),
            force_n: of(&self.force_n),
            vx_mm_s: between(v0[0], v1[0]),
            vy_mm_s: between(v0[1], v1[1]),
        }
    }

    fn resting(&self, row: usize) -> TracePoint {
        let place = |values: &[f64]| values.get(row).copied().unwrap_or(0.0);
        TracePoint { x_mm: place(&self.x_mm), y_mm: place(&self.y_mm), ..TracePoint::default() }
    }

    /// Time from the first row to the last, seconds.
    pub fn duration_s(&self) -> f64 {
        self.t_s.last().copied().unwrap_or(0.0)
    }
}

/// For each row, returns the row whose reading is used. This is the row itself if its reading is
/// valid, otherwise the last valid row if it is at most [`HOLD_S`] earlier.
fn readings(t_s: &[f64], is_good: impl Fn(usize) -> bool) -> Vec<Option<usize>> {
    let mut last = None;
    let row = |row: usize| {
        if is_good(row) {
            last = Some(row);
        }
        last.filter(|last| t_s[row] - t_s[*last] <= HOLD_S + ROUNDING_S)
    };
    (0..t_s.len()).map(row).collect()
}

/// Returns the values of these rows. For a row that is `None`, the value is zero.
fn taken<T: Copy + Default>(rows: &[Option<usize>], values: &[T]) -> Vec<T> {
    let value = |row: &Option<usize>| row.and_then(|row| values.get(row).copied());
    rows.iter().map(|row| value(row).unwrap_or_default()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A trace along x, sampled at `rate_hz`, rounded to `step_mm`.
    fn trace(rate_hz: f64, seconds: f64, step_mm: f64, x_mm: impl Fn(f64) -> f64) -> Trace {
        let rows = (rate_hz * seconds) as usize + 1;
        let t_s: Vec<f64> = (0..rows).map(|i| 3.0 + i as f64 / rate_hz).collect();
        let round = |x: f64| if step_mm > 0.0 { (x / step_mm).round() * step_mm } else { x };
        Trace::new(TraceColumns {
            x_mm: t_s.iter().map(|t| round(x_mm(t - 3.0))).collect(),
            y_mm: vec![1.0; rows],
            force_n: vec![0.4; rows],
            speed_mm_s: None,
            warnings: Vec::new(),
            t_s,
        })
    }

    #[test]
    fn a_quantised_tracker_gives_a_constant_speed() {
        // A 60 Hz tracker with steps of 0.1 mm, read by a 1 kHz recorder that repeats the last
        // value.
        let held = |t: f64| 80.0 * (t * 60.0 + 1e-9).floor() / 60.0;
        for (rate_hz, x_mm) in
            [(60.0, &(|t: f64| 80.0 * t) as &dyn Fn(f64) -> f64), (1000.0, &held)]
        {
            let trace = trace(rate_hz, 2.0, 0.1, x_mm);
            for step in 0..200 {
                let speed = trace.point_at(f64::from(step) / 100.0).speed_mm_s;
                assert!((speed - 80.0).abs() < 2.5, "{rate_hz} Hz: {speed} mm/s");
            }
        }
    }

    #[test]
    fn velocity_follows_turns_and_is_zero_beyond_the_ends() {
        let (amplitude, omega) = (40.0, 2.0 * std::f64::consts::PI);
        let trace = trace(200.0, 3.0, 0.0, |t| amplitude * (omega * t).sin());
        for step in 10..290 {
            let t = f64::from(step) / 100.0;
            let expected = amplitude * omega * (omega * t).cos();
            let point = trace.point_at(t);
            let error = (point.vx_mm_s - expected).abs() / (amplitude * omega);
            assert!(error < 0.01, "{t} s: {} mm/s", point.vx_mm_s);
            assert!((point.speed_mm_s - point.vx_mm_s.abs()).abs() < 6.0);
        }
        assert_eq!(trace.duration_s(), 3.0);
        assert_eq!(trace.point_at(3.0).force_n, 0.4);
        for t in [-0.001, 3.001, f64::INFINITY, f64::NAN] {
            let point = trace.point_at(t);
            assert_eq!((point.speed_mm_s, point.force_n, point.y_mm), (0.0, 0.0, 1.0));
        }
    }

    /// One row with an impossible speed or force changes nothing; after 100 ms of such rows there
    /// is no contact.
    #[test]
    fn rows_that_no_finger_has_are_held_and_then_lost() {
        let made = |bad: std::ops::Range<usize>, speed_mm_s: f64, force_n: f64| {
            let pick = |usual: f64, bad_value: f64| {
                let at = |row: usize| if bad.contains(&row) { bad_value } else { usual };
                (0..400).map(at).collect::<Vec<f64>>()
            };
            Trace::new(TraceColumns {
                t_s: (0..400).map(|row| f64::from(row) / 200.0).collect(),
                x_mm: (0..400).map(|row| 0.4 * f64::from(row)).collect(),
                y_mm: vec![0.0; 400],
                force_n: pick(0.4, force_n),
                speed_mm_s: Some(pick(80.0, speed_mm_s)),
                warnings: Vec::new(),
            })
        };
        let plain = made(0..0, 0.0, 0.0);
        for (speed_mm_s, force_n) in [(80.0, 25.0), (80.0, 1e6), (1e6, 0.4), (2_000.0, 0.4)] {
            for bad in [100..101, 100..120] {
                let held = made(bad, speed_mm_s, force_n);
                for step in 0..4_000 {
                    let t_s = f64::from(step) / 2_000.0;
                    assert_eq!(
                        held.point_at(t_s),
                        plain.point_at(t_s),
                        "{speed_mm_s} {force_n} at {t_s}"
                    );
                }
            }
            let lost = made(100..200, speed_mm_s, force_n);
            assert_eq!(lost.point_at(0.59).force_n, 0.4);
            assert_eq!((lost.point_at(0.61).force_n, lost.point_at(0.9).speed_mm_s), (0.0, 0.0));
            assert_eq!(lost.point_at(1.1), plain.point_at(1.1));
        }
    }

    proptest! {
        #[test]
        fn a_constant_velocity_is_exact_for_any_row_spacing(
            steps in prop::collection::vec(1e-4..0.2f64, 1..200),
            v in -300.0..300.0f64,
        ) {
            let mut t_s = vec![-5.0];
            for step in steps {
                t_s.push(t_s[t_s.len() - 1] + step);
            }
            let rows = t_s.len();
            let trace = Trace::new(TraceColumns {
                x_mm: t_s.iter().map(|t| 7.0 + v * t).collect(),
                y_mm: t_s.iter().map(|t| -0.5 * v * t).collect(),
                force_n: vec![-0.01; rows],
                speed_mm_s: Some(vec![-3.0; rows]),
                warnings: Vec::new(),
                t_s,
            });
            for row in 0..rows {
                let point = trace.point_at(trace.t_s[row]);
                prop_assert!((point.vx_mm_s - v).abs() < 1e-6 * (1.0 + v.abs()), "{}", point.vx_mm_s);
                prop_assert!((point.vy_mm_s + 0.5 * v).abs() < 1e-6 * (1.0 + v.abs()));
                prop_assert_eq!((point.speed_mm_s, point.force_n), (3.0, 0.0));
            }
        }
    }
}
