//! Curves, which all envelope formats use: points in time, with straight lines between them.

use serde::{Deserialize, Serialize};

/// A point of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Time, seconds.
    pub time_s: f64,
    pub value: f64,
}

impl Point {
    #[must_use]
    pub const fn new(time_s: f64, value: f64) -> Self {
        Self { time_s, value }
    }
}

/// Returns the value of a curve at a time, or `None` if the curve has no points. The value is
/// interpolated linearly between points. Before the first point, the curve has this point's value.
/// After the last point, the curve has the last point's value. If several points have the same
/// time, only the last of these points is used.
///
/// ```
/// use htex_exchange::{Point, value_at};
/// let curve = [Point::new(0.0, 0.0), Point::new(1.0, 0.5), Point::new(1.0, 1.0)];
/// assert_eq!(value_at(&curve, 0.5), Some(0.25));
/// assert_eq!(value_at(&curve, 1.0), Some(1.0));
/// assert_eq!(value_at(&[], 1.0), None);
/// ```
#[must_use]
pub fn value_at(curve: &[Point], time_s: f64) -> Option<f64> {
    let after = curve.partition_point(|point| point.time_s <= time_s);
    let before = after.checked_sub(1).and_then(|index| curve.get(index));
    match (before, curve.get(after)) {
        (Some(a), Some(b)) => {
            // `b` is later than `time_s` and `a` is not. So their times differ, even if other
            // points share a time.
            let part = (time_s - a.time_s) / (b.time_s - a.time_s);
            Some(a.value + part * (b.value - a.value))
        }
        (Some(held), None) | (None, Some(held)) => Some(held.value),
        (None, None) => None,
    }
}

/// Evaluates a curve at ascending times.
pub(crate) struct Reader<'a> {
    curve: &'a [Point],
    after: usize,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(curve: &'a [Point]) -> Self {
        Self { curve, after: 0 }
    }

    /// Returns the same as the function [`value_at`], but takes constant time on average if the
    /// times ascend.
    pub(crate) fn value_at(&mut self, time_s: f64) -> Option<f64> {
        while (self.curve.get(self.after)).is_some_and(|point| point.time_s <= time_s) {
            self.after += 1;
        }
        let from = self.after.saturating_sub(1);
        let around = self.curve.get(from..self.curve.len().min(self.after + 1));
        value_at(around.unwrap_or_default(), time_s)
    }
}

/// Returns a curve with fewer points. Leaves out each point that lies within `tolerance` of the
/// straight line between the remaining points (Ramer 1972; Douglas & Peucker 1973).
#[must_use]
pub fn simplified(curve: &[Point], tolerance: f64) -> Vec<Point> {
    let mut keeps = vec![false; curve.len()];
    // `first` is only matched to make sure that there is a point; its value is `false`, like all
    // flags.
    if let (Some(first), Some(last)) = (keeps.first().copied(), curve.len().checked_sub(1)) {
        // An explicit stack is used, because a curve of thousands of points could recurse thousands
        // of levels deep.
        let mut open = vec![(0, last)];
        keeps.iter_mut().take(1).for_each(|keep| *keep = !first);
        keeps.iter_mut().skip(last).for_each(|keep| *keep = true);
        while let Some((from, to)) = open.pop() {
            if let Some(at) = furthest(curve, from, to, tolerance) {
                keeps.iter_mut().skip(at).take(1).for_each(|keep| *keep = true);
                open.extend([(from, at), (at, to)]);
            }
        }
    }
    let kept = curve.iter().zip(keeps).filter(|(_, keep)| *keep);
    kept.map(|(point, _)| *point).collect()
}

/// Returns the point between two others that is furthest from the line between them, if its
/// distance exceeds the tolerance.
fn furthest(curve: &[Point], from: usize, to: usize, tolerance: f64) -> Option<usize> {
    let (a, b) = (curve.get(from)?, curve.get(to)?);
    let ends = [*a, *b];
    let inner = curve.get(from + 1..to)?.iter().enumerate();
    let distance = |point: &Point| {
        let line = value_at(&ends, point.time_s).unwrap_or(point.value);
        (point.value - line).abs()
    };
    let (at, most) = inner
        .map(|(index, point)| (from + 1 + index, distance(point)))
        .max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    (most > tolerance).then_some(at)
}

/// Returns the value of a curve at a time or, if `before` is true, just before that time. The two
/// values differ if two points have this time.
pub(crate) fn side(curve: &[Point], time_s: f64, before: bool) -> Option<f64> {
    let first_here = curve.partition_point(|point| point.time_s < time_s);
    match curve.get(first_here) {
        Some(point) if before && point.time_s == time_s => Some(point.value),
        _ => value_at(curve, time_s),
    }
}
