//! Pairs of a cost and an error measure that are plotted against each other.

use crate::report::Axis;
use htex_format::By;

use crate::tradeoff::error_axis::ErrorAxis;
use crate::tradeoff::front::front;
use crate::tradeoff::point::Point;
use crate::tradeoff::setting::Keep;

/// The cost on the horizontal axis, against which the error is plotted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    /// Size of the stored parameters, bytes. If a plot has this cost, its errors relative to the
    /// fitted spectrum are measured on the model's magnitudes.
    Bytes,
    /// Computing time, nanoseconds per sample. If a plot has this cost, its errors relative to the
    /// fitted spectrum are measured on rendered samples.
    Time,
}

/// A pair of a cost and an error measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Against {
    pub cost: Cost,
    pub error: ErrorAxis,
}

impl Cost {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Bytes => "bytes",
            Self::Time => "time",
        }
    }

    /// Whether a point's cost can be compared with the cost of other points.
    pub(crate) fn compares(self, point: &Point) -> bool {
        match self {
            Self::Bytes => point.how.plays_as_default(),
            Self::Time => point.how.times_compare() && point.how.store == Keep::Model,
        }
    }

    pub(crate) fn amount(self, cost: f64) -> String {
        match self {
            Self::Bytes => format!("{cost} bytes"),
            Self::Time => format!("{cost:.1} ns"),
        }
    }

    pub(crate) fn axis(self) -> Axis {
        match self {
            Self::Bytes => Axis::log("stored parameters / bytes"),
            Self::Time => Axis::log("time of a sample / ns"),
        }
    }
}

impl Against {
    /// Returns the cost and the error of a point. An unknown error is NaN.
    pub(crate) fn place(self, point: &Point) -> (f64, f64) {
        let cost = match self.cost {
            Cost::Bytes => point.bytes as f64,
            Cost::Time => point.ns_per_sample,
        };
        let error = match (self.error, self.cost) {
            (ErrorAxis::HeldOut, _) => point.held_out_error.unwrap_or(f64::NAN),
            (ErrorAxis::Fitted(error), Cost::Bytes) => point.get(By::Magnitude, error.measure()),
            (ErrorAxis::Fitted(error), Cost::Time) => point.get(By::Samples, error.measure()),
        };
        (cost, error)
    }

    /// Returns which points are on the front. Times that differ by no more than their spreads count
    /// as equal: of such points, only the one with the smallest error is on the front of time.
    pub(crate) fn on_front(self, points: &[&Point]) -> Vec<bool> {
        let places: Vec<(f64, f64)> = points.iter().map(|p| self.place(p)).collect();
        let mut on = front(&places);
        if self.cost == Cost::Time {
            let spread = |i: usize| points[i].spread * points[i].ns_per_sample;
            let mut along: Vec<usize> = (0..points.len()).filter(|&i| on[i]).collect();
            along.sort_by(|&a, &b| places[a].0.total_cmp(&places[b].0));
            let tied = |a: usize, b: usize| places[b].0 - places[a].0 <= spread(a) + spread(b);
            on = vec![false; points.len()];
            for tie in ties(&along, tied) {
                // Along a front the error falls as the cost rises, so the last has the smallest
                // error.
                if let Some(&best) = tie.last() {
                    on[best] = true;
                }
            }
        }
        on
    }
}

/// Cuts items into runs. The items are in the order of their costs, and all items of a run are tied
/// with its first item.
fn ties(mut along: &[usize], tied: impl Fn(usize, usize) -> bool) -> Vec<&[usize]> {
    let mut runs = Vec::new();
    while let Some(&first) = along.first() {
        let end = along.iter().position(|&i| !tied(first, i));
        // A cost that is not a number is not tied even with itself; without the 1 the loop would
        // not end.
        let (run, rest) = along.split_at(end.unwrap_or(along.len()).max(1));
        runs.push(run);
        along = rest;
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_within_their_spreads_are_one_point() {
        let ns = [2.0, 2.1, 2.3, 2.5, 9.0];
        // Each spread is 5 %: 2.0 and 2.1 are tied, 2.3 is not tied with 2.0, and 2.5 is tied with
        // 2.3.
        let tied = |a: usize, b: usize| ns[b] - ns[a] <= 0.05 * (ns[a] + ns[b]);
        assert_eq!(ties(&[0, 1, 2, 3, 4], tied), [&[0, 1][..], &[2, 3], &[4]]);
        // A time that is not a number is tied with nothing, not even itself.
        assert_eq!(ties(&[0, 4], |_, _| false), [&[0][..], &[4]]);
    }
}
