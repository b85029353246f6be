//! Knees of Pareto fronts. Beyond the knee of a front, additional cost reduces the error much less
//! than before the knee.

use serde::Serialize;

use crate::tradeoff::against::{Against, Cost};
use crate::tradeoff::error_axis::ErrorAxis;
use crate::tradeoff::point::Point;

/// Smallest error reduction that counts as a step up, in the error's unit.
const STEP: f64 = 0.05;

/// The knee of a Pareto front, and the next more accurate setting on the front.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Knee {
    /// The recording to which the front belongs, or the median of all recordings.
    pub recording: String,
    /// A model's short name, or `all models`.
    pub of: String,
    /// The kind of cost: `bytes` or `time`.
    pub against: &'static str,
    /// Model and setting at the knee.
    pub at: String,
    /// Cost at the knee, in bytes or ns per sample.
    pub cost: f64,
    pub error: ErrorAxis,
    /// Error at the knee. A held-out error is a multiple of the error of a second recording. All
    /// other errors are in decibels.
    pub error_value: f64,
    /// Model and setting of the next step up: the cheapest setting on the front with an error at
    /// least 0.05 lower than the error at the knee. `None` if there is no such setting.
    pub next: Option<String>,
    /// A sentence that describes the knee, and the lower error and higher cost of the next step.
    pub words: String,
}

/// Returns the index of a front's knee. The points (cost, error) must be sorted by increasing cost.
/// The knee is the point furthest below the straight line between the front's ends, with cost on a
/// logarithmic axis. For a front of one or two points, the knee is the first point.
pub fn knee(front: &[(f64, f64)]) -> Option<usize> {
    let (&(low, high_error), &(high, low_error)) = (front.first()?, front.last()?);
    let across = |cost: f64| libm::log(cost / low) / libm::log(high / low);
    let below = |&(cost, error): &(f64, f64)| {
        let line = high_error + across(cost) * (low_error - high_error);
        if high > low { line - error } else { 0.0 }
    };
    // If several points are equally far below, the cheapest counts.
    (0..front.len()).reduce(|best, i| if below(&front[i]) > below(&front[best]) { i } else { best })
}

/// Returns the knees of one recording: of all models together, then of each model.
pub(crate) fn knees(
    recording: &str,
    points: &[&Point],
    models: &[String],
    error: ErrorAxis,
) -> Vec<Knee> {
    let mut knees = Vec::new();
    for cost in [Cost::Bytes, Cost::Time] {
        let against = Against { cost, error };
        let shown: Vec<&Point> = points.iter().copied().filter(|p| cost.compares(p)).collect();
        knees.extend(knee_of(recording, "all models", against, &shown));
        for model in models {
            let own: Vec<&Point> = shown.iter().copied().filter(|p| p.model == *model).collect();
            knees.extend(knee_of(recording, model, against, &own));
        }
    }
    knees
}

fn knee_of(recording: &str, of: &str, against: Against, points: &[&Point]) -> Option<Knee> {
    let along = along_front(points, against);
    let places: Vec<(f64, f64)> = along.iter().map(|p| against.place(p)).collect();
    let at = knee(&places)?;
    let (cost, error) = places[at];
    let is_step = |i: &usize| error - places[*i].1 >= STEP;
    let next = (at + 1..places.len()).find(is_step).map(|i| (&places[i], along[i]));
    let here = format!(
        "{}, {} at {}",
        along[at].name(),
        against.cost.amount(cost),
        against.error.amount(error)
    );
    let words = match next {
        None => format!("{here}: no further step reduces the error"),
        Some((&(next_cost, next_error), next)) => format!(
            "{here}; the next step up, {}, reduces the error by {} for {} more ({:+.0} %)",
            next.name(),
            against.error.amount(error - next_error),
            against.cost.amount(next_cost - cost),
            100.0 * (next_cost / cost - 1.0)
        ),
    };
    Some(Knee {
        recording: recording.to_owned(),
        of: of.to_owned(),
        against: against.cost.name(),
        at: along[at].name(),
        cost,
        error: against.error,
        error_value: error,
        next: next.map(|(_, point)| point.name()),
        words,
    })
}

/// Returns the points of a front by increasing cost; of equal points only the first.
pub(crate) fn along_front<'a>(points: &[&'a Point], against: Against) -> Vec<&'a Point> {
    let places: Vec<(f64, f64)> = points.iter().map(|p| against.place(p)).collect();
    let on = against.on_front(points);
    let mut along: Vec<usize> = (0..points.len()).filter(|&i| on[i]).collect();
    along.sort_by(|&a, &b| places[a].0.total_cmp(&places[b].0));
    along.dedup_by(|b, a| places[*b] == places[*a]);
    along.into_iter().map(|i| points[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_knee_is_where_the_front_bends() {
        let bends = [(2.0, 10.0), (4.0, 8.0), (8.0, 1.0), (16.0, 0.8), (512.0, 0.5)];
        assert_eq!(knee(&bends), Some(2));
        assert_eq!(knee(&[(2.0, 10.0), (4.0, 1.0)]), Some(0));
        assert_eq!(knee(&[(3.0, 1.0)]), Some(0));
        assert_eq!(knee(&[]), None);
    }
}
