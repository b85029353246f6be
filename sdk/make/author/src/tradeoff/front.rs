//! Pareto fronts.

/// Returns which points of (cost, error) are on the Pareto front. A point is on the front if no
/// other point is better. Another point is better if it has less cost and at most the same error,
/// or less error and at most the same cost. A point is never on the front if its cost or its error
/// is not finite. Several points may have the same cost and the same error. Then either all of
/// these points are on the front, or none of them.
pub fn front(points: &[(f64, f64)]) -> Vec<bool> {
    let finite = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let mut order: Vec<usize> = (0..points.len()).filter(|&i| finite(&points[i])).collect();
    let by = |a: f64, b: f64| a.total_cmp(&b);
    order.sort_by(|&a, &b| by(points[a].0, points[b].0).then(by(points[a].1, points[b].1)));
    let mut on = vec![false; points.len()];
    let mut last: Option<(f64, f64)> = None;
    for i in order {
        if last.is_none_or(|last| points[i].1 < last.1 || points[i] == last) {
            on[i] = true;
            last = Some(points[i]);
        }
    }
    on
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn beats(a: (f64, f64), b: (f64, f64)) -> bool {
        a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1)
    }

    #[test]
    fn known_points() {
        let points = [
            (2.0, 5.0),
            (4.0, 3.0),
            (4.0, 4.0),
            (8.0, 3.0),
            (9.0, f64::NAN),
            (16.0, 1.0),
            (4.0, 3.0),
        ];
        let expected = [true, true, false, false, false, true, true];
        assert_eq!(front(&points), expected);
        assert!(front(&[]).is_empty());
    }

    proptest! {
        #[test]
        fn nothing_on_it_is_beaten_and_all_else_is(
            // Few different values, so that ties occur.
            points in prop::collection::vec((0u8..12, 0u8..12), 0..60)
        ) {
            let points: Vec<(f64, f64)> =
                points.into_iter().map(|(a, b)| (f64::from(a), f64::from(b))).collect();
            let on = front(&points);
            for (i, &point) in points.iter().enumerate() {
                let beaten = points.iter().any(|&other| beats(other, point));
                prop_assert_eq!(on[i], !beaten);
            }
        }
    }
}
