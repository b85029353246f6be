//! Position of the finger along its path, for models that follow the motion themselves. The
//! position increases in the direction of the first stroke and decreases in the opposite direction.
//! Therefore, a place on the surface has the same position on forward and back strokes.
//!
//! For a trace, the position is the integral of the smoothed velocity. The recorded positions are
//! not used directly, because the positions from a tracker change in steps.

use htex_play::Motion;

use crate::motion::Course;
use crate::trace::Trace;

/// Position of the finger along its path over time.
#[derive(Debug)]
pub(crate) enum Path {
    /// A constant speed, mm/s, from the start of the scene.
    Steady(f64),
    Trace(TracePath),
    Live(LivePath),
}

/// Speed and position along the path at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PathPoint {
    /// Negative on the back stroke.
    pub(crate) speed_mm_s: f64,
    pub(crate) position_mm: f64,
}

impl Path {
    pub(crate) fn new(course: &Course) -> Self {
        match course {
            Course::Constant(constant) => Self::Steady(constant.speed_mm_s),
            Course::Trace(trace, way) => Self::Trace(TracePath::new(trace, *way)),
            Course::Live => Self::Live(LivePath::default()),
        }
    }

    /// Returns speed and position at a time in seconds. Does not allocate.
    pub(crate) fn point_at(&self, t_s: f64) -> PathPoint {
        match self {
            Self::Steady(speed_mm_s) => {
                PathPoint { speed_mm_s: *speed_mm_s, position_mm: speed_mm_s * t_s }
            }
            Self::Trace(path) => path.point_at(t_s),
            Self::Live(path) => path.point_at(t_s),
        }
    }

    /// Updates the path of a live scene with the finger's motion at `t_s` seconds.
    pub(crate) fn moved(&mut self, finger: &Motion, t_s: f64) {
        if let Self::Live(path) = self {
            path.moved(finger, t_s);
        }
    }
}

/// The path of a trace: the integral of its smoothed velocity. The recorded positions are not used,
/// because they change in the tracker's steps.
#[derive(Debug)]
pub(crate) struct TracePath {
    t_s: Vec<f64>,
    speed_mm_s: Vec<f64>,
    position_mm: Vec<f64>,
}

impl TracePath {
    /// Makes the path of a trace whose first stroke goes in the direction `way`.
    fn new(trace: &Trace, way: [f64; 2]) -> Self {
        let signed = |[x, y]: &[f64; 2]| libm::hypot(*x, *y).copysign(x * way[0] + y * way[1]);
        let speed_mm_s: Vec<f64> = trace.velocity_mm_s.iter().map(signed).collect();
        let mut position_mm = Vec::with_capacity(speed_mm_s.len());
        let mut sum = 0.0;
        for row in 0..speed_mm_s.len() {
            if row > 0 {
                let mean = 0.5 * (speed_mm_s[row - 1] + speed_mm_s[row]);
                sum += mean * (trace.t_s[row] - trace.t_s[row - 1]);
            }
            position_mm.push(sum);
        }
        Self { t_s: trace.t_s.clone(), speed_mm_s, position_mm }
    }

    /// Returns the speed, interpolated linearly between rows, and its integral. Before the first
    /// row and after the last row, the finger is at rest.
    fn point_at(&self, t_s: f64) -> PathPoint {
        let above = self.t_s.partition_point(|t| *t <= t_s);
        let row = above.saturating_sub(1);
        let resting = |row: usize| PathPoint {
            speed_mm_s: 0.0,
            position_mm: self.position_mm.get(row).copied().unwrap_or(0.0),
        };
        if above == 0 || above == self.t_s.len() {
            return resting(row);
        }
        let length_s = self.t_s[above] - self.t_s[row];
        let ahead_s = t_s - self.t_s[row];
        let slope = (self.speed_mm_s[above] - self.speed_mm_s[row]) / length_s;
        PathPoint {
            speed_mm_s: self.speed_mm_s[row] + slope * ahead_s,
            position_mm: self.position_mm[row]
                + ahead_s * (self.speed_mm_s[row] + 0.5 * slope * ahead_s),
        }
    }
}

/// The path of a live finger. From one update to the next, the position changes by the distance
/// between the two places if both are known, otherwise by the integral of the speed.
#[derive(Debug, Default)]
pub(crate) struct LivePath {
    t_s: f64,
    speed_mm_s: f64,
    position_mm: f64,
    place_mm: Option<[f64; 2]>,
}

impl LivePath {
    fn point_at(&self, t_s: f64) -> PathPoint {
        PathPoint {
            speed_mm_s: self.speed_mm_s,
            position_mm: self.position_mm + self.speed_mm_s * (t_s - self.t_s),
        }
    }

    fn moved(&mut self, finger: &Motion, t_s: f64) {
        let integrated = self.point_at(t_s).position_mm;
        self.position_mm = match self.place_mm.zip(finger.place_mm) {
            Some(([x0, y0], [x1, y1])) => {
                // The sign comes from the speed, because the places do not tell a forward stroke
                // from a back stroke.
                let way = libm::hypot(x1 - x0, y1 - y0).copysign(finger.speed_mm_s);
                // This replaces the integral of the speed since the last update, which was only an
                // extrapolation.
                self.position_mm + way
            }
            None => integrated,
        };
        (self.t_s, self.speed_mm_s, self.place_mm) = (t_s, finger.speed_mm_s, finger.place_mm);
    }
}

#[cfg(test)]
mod tests {
    use htex_recording::TraceColumns;

    use super::*;

    fn near(point: PathPoint, speed_mm_s: f64, position_mm: f64) {
        let close = (point.speed_mm_s - speed_mm_s).abs() < 0.5
            && (point.position_mm - position_mm).abs() < 0.05;
        assert!(close, "{point:?}, not {speed_mm_s} mm/s at {position_mm} mm");
    }

    #[test]
    fn a_trace_there_and_back_ends_where_it_began() {
        let (there, way) = ([0.6, -0.8], |t: f64| 80.0 * (1.0 - (2.0 * t - 1.0).abs()));
        let t_s: Vec<f64> = (0..=200).map(|row| f64::from(row) / 200.0).collect();
        let trace = Trace::new(TraceColumns {
            x_mm: t_s.iter().map(|&t| there[0] * way(t)).collect(),
            y_mm: t_s.iter().map(|&t| there[1] * way(t)).collect(),
            force_n: vec![0.4; t_s.len()],
            speed_mm_s: None,
            warnings: Vec::new(),
            t_s,
        });
        let path = Path::Trace(TracePath::new(&trace, there));
        near(path.point_at(0.25), 160.0, 40.0);
        near(path.point_at(0.75), -160.0, 40.0);
        near(path.point_at(0.9999), -160.0, 0.0);
        for t in [0.1, 0.2, 0.3, 0.4, 0.45] {
            let (out, back) = (path.point_at(t), path.point_at(1.0 - t));
            assert!((out.position_mm - back.position_mm).abs() < 1e-9);
            assert!((out.speed_mm_s + back.speed_mm_s).abs() < 1e-9);
        }
        assert_eq!(path.point_at(2.0).speed_mm_s, 0.0);
    }

    #[test]
    fn a_live_finger_goes_by_its_place_where_it_is_known() {
        let mut path = Path::Live(LivePath::default());
        let finger =
            |speed_mm_s, place: Option<[f64; 2]>| Motion::new(speed_mm_s, 0.4).with_place_mm(place);
        path.moved(&finger(100.0, None), 1.0);
        near(path.point_at(1.5), 100.0, 50.0);
        path.moved(&finger(100.0, Some([7.0, 0.0])), 1.5);
        near(path.point_at(1.6), 100.0, 60.0);
        path.moved(&finger(100.0, Some([16.0, 0.0])), 1.6);
        near(path.point_at(1.6), 100.0, 59.0);
        path.moved(&finger(-50.0, Some([13.0, 4.0])), 1.7);
        near(path.point_at(1.8), -50.0, 49.0);
    }
}
