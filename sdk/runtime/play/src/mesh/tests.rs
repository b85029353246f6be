use proptest::prelude::*;

use super::*;

fn at(mesh: &Mesh, speed: f64, force: f64) -> Vec<(usize, f64)> {
    mesh.weights(speed, force).iter().collect()
}

#[test]
fn corners_edges_middle_and_outside_of_a_square() {
    let square = [[50.0, 0.2], [150.0, 0.2], [50.0, 0.8], [150.0, 0.8]];
    let mesh = Mesh::new(&square);
    // Far outside, the nearest corner plays. Next to an edge, the nearest point of the edge plays.
    assert_eq!(at(&mesh, 1e9, 100.0), [(3, 1.0)]);
    assert_eq!(at(&mesh, 1e300, 1e300), [(3, 1.0)]);
    let beside = at(&mesh, 100.0, 0.0);
    assert_eq!(beside.len(), 2);
    assert!(beside.iter().all(|(i, w)| *i < 2 && (w - 0.5).abs() < 1e-12));
    // Inside, the weighted mean of the conditions is the point itself.
    for (speed, force) in [(60.0, 0.3), (100.0, 0.5), (149.0, 0.79)] {
        let weights = at(&mesh, speed, force);
        let mean = |axis: usize| weights.iter().map(|(i, w)| square[*i][axis] * w).sum::<f64>();
        assert!((mean(0) - speed).abs() < 1e-9 && (mean(1) - force).abs() < 1e-12);
    }
}

#[test]
fn one_condition_and_conditions_on_a_line() {
    assert_eq!(at(&Mesh::new(&[[80.0, 0.4]]), 10.0, 3.0), [(0, 1.0)]);
    // Forces within the tolerance count as one, so the weights depend only on the speed.
    for forces in [[0.4, 0.4, 0.4], [0.4069, 0.4061, 0.4014]] {
        let line = Mesh::new(&[[160.0, forces[2]], [40.0, forces[0]], [80.0, forces[1]]]);
        for force in [0.0, 0.4, 0.407, 9.0] {
            assert_eq!(at(&line, 60.0, force), [(1, 0.5), (2, 0.5)]);
            assert_eq!(at(&line, 80.0, force), [(2, 1.0)]);
            assert_eq!(at(&line, 0.0, force), [(1, 1.0)]);
        }
    }
}

/// A narrow triangle at two edges belongs to the edge of the lower conditions, whatever the order
/// of the conditions.
#[test]
fn a_triangle_beside_two_edges_belongs_to_the_first() {
    let places = [[10.0, 0.1], [97.0, 1.0], [100.0, 0.97]];
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        let mesh = Mesh::new(&order.map(|i: usize| places[i]));
        let mixed: Vec<usize> = at(&mesh, 55.0, 0.55).iter().map(|(i, _)| order[*i]).collect();
        // The third condition lies between the first and the second, on the edge between them.
        assert_eq!(mixed, [0, 2], "{order:?}");
    }
}

/// If conditions are equal within the tolerance, each condition is still reproduced.
#[test]
fn conditions_that_are_the_same_stay_apart() {
    let points = [[40.0, 0.4], [80.0, 0.4], [80.1, 0.41], [80.0, 0.405]];
    for (i, [speed, force]) in points.iter().enumerate() {
        assert_eq!(at(&Mesh::new(&points), *speed, *force), [(i, 1.0)]);
    }
}

/// The largest number of conditions that an asset may have, in arrangements that make insertion
/// slow: on one line, on lines that change every triangle, in narrow triangles, and around a corner
/// that all triangles share.
fn many(count: usize) -> Vec<(&'static str, Vec<[f64; 2]>)> {
    let part = |i: usize| i as f64 / count as f64;
    let mixed = |i: usize| (i * 7919) % count;
    let all = |place: &dyn Fn(usize) -> [f64; 2]| (0..count).map(place).collect();
    let circle = |i: usize| [part(i).cos(), part(i).sin()].map(|x| 2.0 + x);
    vec![
        ("one line: one force", all(&|i| [10.0 + part(mixed(i)), 0.4])),
        ("one line: one speed", all(&|i| [80.0, 0.4 + part(mixed(i))])),
        ("one line, bent by rounding", all(&|i| [10.0 + i as f64, 1.0 + 1.1 * i as f64])),
        (
            "a line and one beside",
            all(&|i| [10.0 + part(i), if i + 1 == count { 0.9 } else { 0.4 }]),
        ),
        (
            "a cross",
            all(&|i| {
                if i % 2 == 0 { [100.0, 0.2 + part(i)] } else { [100.0 + part(i), 0.7] }
            }),
        ),
        ("an arc", all(&circle)),
        ("an arc and its centre", all(&|i| if i == 0 { [2.0; 2] } else { circle(i) })),
        ("a grid", all(&|i| [10.0 + (i % 100) as f64, 1.0 + (i / 100) as f64])),
    ]
}

/// On a line that is not parallel to an axis, rounding moves conditions to one or the other side of
/// the line.
#[test]
fn conditions_on_a_slanted_line_are_each_met() {
    for steep in [-0.019, 0.011, 1.1] {
        let points: Vec<[f64; 2]> =
            (0..50).map(|i| [10.0 + f64::from(i), 1.0 + steep * f64::from(i)]).collect();
        for (i, [speed, force]) in points.iter().enumerate() {
            assert_eq!(at(&Mesh::new(&points), *speed, *force), [(i, 1.0)]);
        }
    }
}

/// The time for many conditions grows nearly in proportion to their number. Without the chosen
/// order, each arrangement takes from 5 s to a minute. With this order, each takes a few tenths of
/// a second.
#[test]
fn many_conditions_are_each_met_and_none_costs_as_much_as_all() {
    let count = 40_000;
    for (what, points) in many(count) {
        let mesh = Mesh::new(&points);
        for (i, [speed, force]) in points.iter().enumerate().step_by(count / 50) {
            assert_eq!(at(&mesh, *speed, *force), [(i, 1.0)], "{what}");
        }
    }
}

/// A point that is inserted into a line is compared with all points on the line.
#[test]
fn of_many_places_three_that_span_a_triangle_go_first() {
    for (what, places) in many(2_000) {
        let order =
            triangulation::line(&places).and_then(|line| triangulation::order(&places, &line));
        let Some(order) = order else {
            assert!(what.starts_with("one line"), "{what}");
            continue;
        };
        let [a, b, c] = [order[0], order[1], order[2]].map(|i| places[i]);
        assert!(area(a, b, c) != 0.0, "{what}");
        let mut sorted = order;
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..places.len()), "{what}");
    }
}

/// A square, four corners of a slanted square, and eight conditions on a circle. Each arrangement
/// has several Delaunay triangulations. The mesh uses the fan from the condition with the lowest
/// speed and, among these, the lowest force.
#[test]
fn conditions_on_a_circle_are_fanned_from_the_lowest() {
    let square: &[[f64; 2]] = &[[150.0, 0.8], [50.0, 0.8], [150.0, 0.2], [50.0, 0.2]];
    let slanted: &[[f64; 2]] = &[[140.0, 1.0], [100.0, 0.2], [40.0, 0.5], [200.0, 0.7]];
    let octagon: Vec<[f64; 2]> =
        [[1, 4], [4, 1], [4, -1], [-1, 4], [-4, 1], [-4, -1], [1, -4], [-1, -4]]
            .map(|[x, y]| [f64::from(6 + x) * 20.0, f64::from(6 + y) * 0.1])
            .to_vec();
    for (points, apex, count) in [(square, 3, 2), (slanted, 2, 2), (&octagon, 5, 6)] {
        let triangles: Vec<[usize; 3]> = Mesh::new(points).triangles().collect();
        assert_eq!(triangles.len(), count);
        assert!(triangles.iter().all(|t| t.contains(&apex)), "{triangles:?}");
    }
    // These do not lie on a circle, so the Delaunay triangulation decides.
    let kite = [[150.0, 0.85], [50.0, 0.8], [150.0, 0.2], [50.0, 0.2]];
    assert!(Mesh::new(&kite).triangles().all(|t| t.contains(&1) && t.contains(&2)));
}

/// Asserts that two conditions have half the weight each.
fn halves(mesh: &Mesh, [speed, force]: [f64; 2], conditions: [usize; 2]) {
    let weights = at(mesh, speed, force);
    let near = weights.iter().all(|(_, w)| (w - 0.5).abs() < 1e-12);
    let which: Vec<usize> = weights.iter().map(|(i, _)| *i).collect();
    assert!(which == conditions && near, "{weights:?}");
}

/// The mesh uses the stored diagonal instead of the Delaunay diagonal, and merges no equal values.
/// A motion outside plays as at the nearest point of an outer edge.
#[test]
fn stored_triangles_replace_those_that_are_found() {
    let square = [[40.0, 0.4], [40.0, 1.2], [160.0, 1.2], [160.0, 0.4]];
    let found = Mesh::new(&square);
    let stored = Mesh::with_triangles(&square, &[[0, 1, 3], [3, 1, 2]]).unwrap();
    halves(&found, [100.0, 0.8], [0, 2]);
    halves(&stored, [100.0, 0.8], [1, 3]);
    halves(&stored, [100.0, 0.1], [0, 3]);
    assert_eq!(stored.locate(100.0, 0.1).1, [100.0, 0.4]);
    assert_eq!(at(&stored, 500.0, 9.0), [(2, 1.0)]);
    assert!(stored.surrounds(100.0, 0.8) && !stored.surrounds(100.0, 0.39));
    // Here, two forces within 5 % stay two values.
    let near = [[40.0, 0.4], [160.0, 0.4], [100.0, 0.41]];
    let narrow = Mesh::with_triangles(&near, &[[2, 1, 0]]).unwrap();
    assert_eq!(at(&narrow, 100.0, 0.41), [(2, 1.0)]);
    halves(&narrow, [100.0, 0.4], [0, 1]);
    assert!(Mesh::with_triangles(&square, &[[0, 1, 3]]).is_err());
}

/// Makes speeds or forces, each a few tenths above the previous value.
fn axis(
    count: impl Into<proptest::collection::SizeRange>,
    from: f64,
) -> impl Strategy<Value = Vec<f64>> {
    let steps = prop::collection::vec(1.4..2.2, count);
    (from..4.0 * from, steps).prop_map(|(start, steps)| {
        let next = |x: &mut f64, step: f64| Some(std::mem::replace(x, *x * step));
        steps.into_iter().scan(start, next).collect()
    })
}

/// Makes conditions as a protocol plans them: lines parallel to an axis, other lines, and grids.
fn meant() -> impl Strategy<Value = Vec<[f64; 2]>> {
    let across =
        (axis(2..=6usize, 10.0), 0.1..0.4, 0.5..1.0f64).prop_map(|(speeds, low, steep)| {
            let force = |v: f64| low * (1.0 + steep * (v / speeds[0] - 1.0));
            speeds.iter().map(|v| [*v, force(*v)]).collect()
        });
    let grid = (axis(1..=5usize, 10.0), axis(1..=5usize, 0.1)).prop_map(|(speeds, forces)| {
        let row = |f: &f64| speeds.iter().map(|v| [*v, *f]).collect::<Vec<_>>();
        forces.iter().flat_map(row).collect()
    });
    prop_oneof![1 => across, 3 => grid]
}

/// Makes conditions that a moving hand reached, within 1 % of the planned conditions. Their levels
/// are powers of speed and force, within 0.5 dB.
fn measured() -> impl Strategy<Value = (Vec<[f64; 2]>, Vec<f64>)> {
    let scattered = meant().prop_flat_map(|points| {
        let near = |[v, f]: [f64; 2]| [v * 0.99..v * 1.01, f * 0.99..f * 1.01];
        points.into_iter().map(near).collect::<Vec<_>>()
    });
    (scattered, -0.5..1.2, 0.0..1.2f64).prop_flat_map(|(points, of_speed, of_force)| {
        let decibels = prop::collection::vec(-0.5..0.5, points.len());
        let level = move |([v, f], db): (&[f64; 2], f64)| {
            v.powf(of_speed) * f.powf(of_force) * 10f64.powf(db / 20.0)
        };
        decibels.prop_map(move |db| {
            let levels = points.iter().zip(db).map(level).collect();
            (points.clone(), levels)
        })
    })
}

/// Makes planned or measured conditions, some of them repeated within the tolerance. Also makes
/// another order of the same conditions.
fn in_two_orders() -> impl Strategy<Value = (Vec<[f64; 2]>, Vec<usize>)> {
    let points = prop_oneof![meant(), measured().prop_map(|(points, _)| points)];
    points.prop_flat_map(|points| {
        let order: Vec<usize> = (0..points.len()).collect();
        (Just(points), Just(order).prop_shuffle())
    })
}

/// Returns whether three conditions are too close to a line for the triangle to be stored.
fn is_flat(points: &[[f64; 2]], triangle: [usize; 3]) -> bool {
    let most = |axis: usize| points.iter().map(|p| p[axis]).fold(0.0, f64::max);
    let [a, b, c] = triangle.map(|i| [points[i][0] / most(0), points[i][1] / most(1)]);
    area(a, b, c).abs() < 1e-8
}

fn weight_of(mesh: &Mesh, [v, f]: [f64; 2], condition: usize) -> f64 {
    let all = at(mesh, v, f);
    let own = all.iter().find(|(i, _)| *i == condition);
    own.map_or(0.0, |(_, weight)| *weight)
}

/// Test motions: across the range, up to 50 % outside it, and close to each condition.
fn motions() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec([0.0..1.0, 0.0..1.0], 24)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// The same conditions in another order have bit-identical weights.
    #[test]
    fn the_order_of_conditions_has_no_effect((points, order) in in_two_orders(), places in motions()) {
        let shuffled: Vec<[f64; 2]> = order.iter().map(|i| points[*i]).collect();
        let (mesh, other) = (Mesh::new(&points), Mesh::new(&shuffled));
        let most = |axis: usize| points.iter().map(|p| p[axis]).fold(0.0, f64::max);
        for [v, f] in places {
            let motion = [1.2 * v * most(0), 1.2 * f * most(1)];
            let theirs = at(&other, motion[0], motion[1]);
            let theirs: Vec<(usize, f64)> = theirs.iter().map(|(i, w)| (order[*i], *w)).collect();
            prop_assert_eq!(at(&mesh, motion[0], motion[1]), theirs, "at {:?}", motion);
        }
    }

    /// For all measured lines and grids, the mesh reproduces each condition. Close to a condition,
    /// this condition has most of the weight. The weights are continuous.
    #[test]
    fn measured_conditions_are_met_and_nothing_jumps(
        (points, levels) in measured(), places in motions(),
    ) {
        let mesh = Mesh::new(&points);
        let db = |[v, f]: [f64; 2]| {
            let level: f64 = at(&mesh, v, f).iter().map(|(i, w)| w * levels[*i]).sum();
            20.0 * level.log10()
        };
        let most = |axis: usize| points.iter().map(|p| p[axis]).fold(0.0, f64::max);
        let mut tried: Vec<[f64; 2]> = places.iter().map(|p| [1.5 * p[0] * most(0), 1.5 * p[1] * most(1)]).collect();
        for (i, [v, f]) in points.iter().enumerate() {
            prop_assert_eq!(at(&mesh, *v, *f), [(i, 1.0)]);
            let beside = &places[i % places.len()];
            let close = [v * (0.98 + 0.04 * beside[0]), f * (0.98 + 0.04 * beside[1])];
            let own = at(&mesh, close[0], close[1]).into_iter().find(|(k, _)| *k == i);
            prop_assert!(own.is_some_and(|(_, w)| w > 0.7), "condition {i} at {close:?}: {own:?}");
            tried.push(close);
        }
        for [v, f] in tried {
            for on in [[1.01, 1.0], [1.0, 1.01], [1.01, 1.01], [1.01, 0.99]] {
                let step = db([v * on[0], f * on[1]]) - db([v, f]);
                prop_assert!(step.abs() < 0.5, "{step} dB from {v} mm/s, {f} N in {on:?}: {points:?}");
            }
        }
    }

    /// The triangles that a mesh finds are valid as stored triangles, and give the same weights in
    /// any stored order. At each condition, only this condition's weight is not zero. No weight
    /// jumps.
    #[test]
    fn found_triangles_can_be_stored((points, order) in in_two_orders(), places in motions(), turn in any::<bool>()) {
        let (axes, coordinates) = triangulation::placed(&points, false);
        let unmerged = triangulation::meshed(&points, axes, &coordinates);
        let found: Vec<[usize; 3]> = unmerged.triangles().collect();
        let Ok(stored) = Mesh::with_triangles(&points, &found) else {
            // Conditions on one line, some slightly off it by rounding, have no triangles to store.
            prop_assert!(found.iter().any(|t| is_flat(&points, *t)), "{points:?}: {found:?}");
            return Ok(());
        };
        if found.is_empty() {
            return Ok(());
        }
        let shuffled: Vec<[f64; 2]> = order.iter().map(|i| points[*i]).collect();
        let place = |i: usize| order.iter().position(|k| *k == i).unwrap();
        let moved: Vec<[usize; 3]> = found.iter().rev().map(|corners| {
            let [a, b, c] = corners.map(place);
            if turn { [c, b, a] } else { [b, c, a] }
        }).collect();
        let other = Mesh::with_triangles(&shuffled, &moved).unwrap();
        for (i, [v, f]) in points.iter().enumerate() {
            prop_assert_eq!(at(&stored, *v, *f), [(i, 1.0)]);
        }
        let most = |axis: usize| points.iter().map(|p| p[axis]).fold(0.0, f64::max);
        for [v, f] in places {
            let motion = [1.2 * v * most(0), 1.2 * f * most(1)];
            let theirs: Vec<(usize, f64)> = at(&other, motion[0], motion[1])
                .into_iter().map(|(i, w)| (order[i], w)).collect();
            prop_assert_eq!(at(&stored, motion[0], motion[1]), theirs, "at {:?}", motion);
            // A step of 1e-9 of the ranges changes no weight by more than the height of the
            // narrowest triangle allows.
            let beside = stored.weights(motion[0] + 1e-9 * most(0), motion[1]);
            let step = beside.iter().map(|(i, w)| (w - weight_of(&stored, motion, i)).abs());
            prop_assert!(step.fold(0.0, f64::max) < 1e-3, "at {:?}", motion);
        }
    }
}
