//! Velocity, computed from tracked positions.

/// Half the width of the triangular window over which the velocity is averaged, seconds. Trackers
/// are slow and quantised (60 Hz, 0.1 mm). A shorter window would show the steps of their positions
/// instead of the motion.
const REACH_S: f64 = 0.05;

/// Returns the velocity at the ascending times `at_s`, computed from positions at the times `t_s`.
/// The times `t_s` must start at 0 and ascend strictly.
///
/// The velocity is the slope of the position, averaged with a triangular window of 100 ms. Between
/// rows, the position is interpolated linearly. A constant velocity is computed exactly, even if
/// the rows are not evenly spaced. A 60 Hz tracker that repeats its last value does not disturb the
/// result. The velocity is constant until 50 ms after the first row, and again from 50 ms before
/// the last row. The unit of the velocity is the position's unit per second. The function
/// integrates the position and computes the velocity as the second difference of this integral,
/// over steps of 50 ms.
///
/// ```
/// # use htex_recording::velocity;
/// let (t_s, x_mm) = ([0.0, 0.1, 0.3], [2.0, 10.0, 26.0]);
/// let v_mm_s = velocity(&t_s, &x_mm, [0.0, 0.17, 0.3]);
/// assert!(v_mm_s.iter().all(|v| (v - 80.0).abs() < 1e-9));
/// ```
#[must_use]
pub fn velocity(t_s: &[f64], position: &[f64], at_s: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let at_s = at_s.into_iter();
    let rows = t_s.len().min(position.len());
    let (t_s, position) = (&t_s[..rows], &position[..rows]);
    let end_s = t_s.last().copied().unwrap_or(0.0);
    // A short recording still has to fit both sides of the window.
    let reach_s = REACH_S.min(end_s / 2.0);
    if rows < 2 || reach_s.is_nan() || reach_s <= 0.0 {
        return at_s.map(|_| 0.0).collect();
    }
    let mut before = Integral::new(t_s, position);
    // Three integrals that only move forwards take linear time. One integral would have to go back
    // for each time.
    let (mut here, mut after) = (before.clone(), before.clone());
    let at = |t: f64| {
        let t = t.clamp(reach_s, end_s - reach_s);
        let outer = before.value_at(t - reach_s) + after.value_at(t + reach_s);
        (outer - 2.0 * here.value_at(t)) / (reach_s * reach_s)
    };
    at_s.map(at).collect()
}

/// The integral over time of the position relative to the first position, from the first row on. It
/// is evaluated at ascending times.
#[derive(Clone)]
struct Integral<'a> {
    t_s: &'a [f64],
    position: &'a [f64],
    row: usize,
    sum: f64,
}

impl<'a> Integral<'a> {
    fn new(t_s: &'a [f64], position: &'a [f64]) -> Self {
        Self { t_s, position, row: 0, sum: 0.0 }
    }

    /// Returns the time and position of a row.
    fn point(&self, row: usize) -> (f64, f64) {
        // A constant offset cancels out in the second difference and would only cost digits.
        (self.t_s[row], self.position[row] - self.position[0])
    }

    fn value_at(&mut self, t_s: f64) -> f64 {
        let last = self.t_s.len() - 1;
        // It stops one row early, so that a time at the end still has a row after it.
        while self.row + 1 < last && self.t_s[self.row + 1] <= t_s {
            let ((t0, x0), (t1, x1)) = (self.point(self.row), self.point(self.row + 1));
            self.sum += 0.5 * (x0 + x1) * (t1 - t0);
            self.row += 1;
        }
        let ((t0, x0), (t1, x1)) = (self.point(self.row), self.point(self.row + 1));
        let ahead = t_s - t0;
        let slope = (x1 - x0) / (t1 - t0);
        self.sum + ahead * (x0 + 0.5 * slope * ahead)
    }
}
