//! Triangulation of the recorded conditions, and the edges of their hull.

use std::cmp::Ordering;

use htex_dsp::order;
use htex_format::Condition;
use spade::{DelaunayTriangulation, HierarchyHintGenerator, Point2, Triangulation};

use super::axis::Axis;
use super::cells::fanned;
use super::{Face, Mesh, Side};

/// Triangulates recorded conditions by the rules of the specification.
pub(super) fn mesh(conditions: &[[f64; 2]]) -> Mesh {
    let (mut axes, mut places) = placed(conditions, true);
    if !are_apart(&places) {
        // Merging may give two conditions the same coordinates. Then nothing is merged, so that
        // each condition keeps its own place.
        (axes, places) = placed(conditions, false);
    }
    meshed(conditions, axes, &places)
}

/// Triangulates conditions at their coordinates.
pub(super) fn meshed(conditions: &[[f64; 2]], axes: [Axis; 2], places: &[[f64; 2]]) -> Mesh {
    let (numbers, places) = sorted(conditions, places);
    let (mut faces, mut sides) = match line(&places) {
        None => (vec![], vec![]),
        Some(line) => match triangulate(&places, &line) {
            Some((faces, edges)) => {
                let side = |ends: &[usize; 2]| Side::new(*ends, &places);
                (faces, edges.iter().map(side).collect())
            }
            None => (vec![], vec![line]),
        },
    };
    let edges = Edges::new(&faces);
    for (i, side) in sides.iter_mut().enumerate() {
        take_slivers(i, side, &mut faces, &edges, &places);
    }
    Mesh { only: places.first().copied().unwrap_or_default(), numbers, axes, faces, sides }
}

/// Returns the numbers and coordinates of all conditions, in ascending order of their coordinates.
/// The mesh built from them does not depend on the caller's order.
pub(super) fn sorted(conditions: &[[f64; 2]], places: &[[f64; 2]]) -> (Vec<usize>, Vec<[f64; 2]>) {
    let numbers = order::order(conditions.len(), &|a, b| {
        let by_motion = || ascends(&conditions[a], &conditions[b]);
        ascends(&places[a], &places[b]).then_with(by_motion)
    });
    let places = numbers.iter().map(|i| places[*i]).collect();
    (numbers, places)
}

fn ascends(a: &[f64; 2], b: &[f64; 2]) -> Ordering {
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
}

/// Returns both axes, and the coordinates of all conditions.
pub(super) fn placed(conditions: &[[f64; 2]], merged: bool) -> ([Axis; 2], Vec<[f64; 2]>) {
    let values = |axis: usize| conditions.iter().map(|c| c[axis]).collect();
    let [speed, force] = [0, 1].map(|axis| Axis::new(values(axis), merged));
    let place = |c: &[f64; 2]| [speed.place(c[0]), force.place(c[1])];
    let places = conditions.iter().map(place).collect();
    ([speed, force], places)
}

/// Returns whether no two conditions have the same coordinates.
fn are_apart(places: &[[f64; 2]]) -> bool {
    let mut sorted = places.to_vec();
    order::sort_by(&mut sorted, ascends);
    sorted.windows(2).all(|pair| pair[0] != pair[1])
}

type Triangles = (Vec<Face>, Vec<[usize; 2]>);
/// A triangulation with a hierarchy of hints. The hints make the time to locate a point logarithmic
/// in the number of points.
type Delaunay = DelaunayTriangulation<Point2<f64>, (), (), (), HierarchyHintGenerator<f64>>;

/// Largest distance from a line that counts as rounding, relative to the largest speed and force.
const ROUNDING: f64 = 1e-9;
/// Largest number of points that are inserted in ascending order.
const FEW: usize = 1000;

/// Returns the order in which to insert the points, or `None` if all points lie on the given line.
///
/// Inserting a point into a line takes time proportional to the number of points on it. Therefore,
/// if there are many points, three points that span a triangle come first, and the others follow in
/// pseudo-random order. An insertion then changes six triangles on average. In another order it may
/// change all triangles.
pub(super) fn order(places: &[[f64; 2]], line: &Side) -> Option<Vec<usize>> {
    let distance = |i: usize| line.distance2(places[i]);
    let farthest = (0..places.len()).max_by(|a, b| distance(*a).total_cmp(&distance(*b)))?;
    if distance(farthest) <= ROUNDING * ROUNDING {
        return None;
    }
    let mut order: Vec<usize> = (0..places.len()).collect();
    if places.len() > FEW {
        let (first, last) = (line.conditions.first(), line.conditions.last());
        let is_corner = |i: &usize| Some(i) == first || Some(i) == last || *i == farthest;
        let key = |i: &usize| (!is_corner(i), scattered(*i as u64));
        order::sort_by(&mut order, |a, b| key(a).cmp(&key(b)));
    }
    Some(order)
}

/// Returns a pseudo-random number for an index (SplitMix64, Steele et al. 2014).
fn scattered(i: u64) -> u64 {
    let mut z = i.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Returns the triangles and the edges of the hull, or `None` if the points do not span a triangle.
fn triangulate(places: &[[f64; 2]], line: &Side) -> Option<Triangles> {
    let mut mesh = Delaunay::new();
    let mut index = Vec::new();
    for i in order(places, line)? {
        let handle = mesh.insert(Point2::new(places[i][0], places[i][1])).ok()?;
        // The library returns an existing vertex if the point is already present, so only a new one
        // gets an index.
        if handle.index() == index.len() {
            index.push(i);
        }
    }
    let face =
        |corners: [usize; 3]| Face { corners, places: corners.map(|i| places[i]), side: None };
    let triangles: Vec<[usize; 3]> =
        mesh.inner_faces().map(|f| f.vertices().map(|v| index[v.fix().index()])).collect();
    let faces: Vec<Face> = fanned(&triangles, places).into_iter().map(face).collect();
    let corner = |v: spade::handles::FixedVertexHandle| index[v.index()];
    let mut edges: Vec<[usize; 2]> = mesh
        .convex_hull()
        .map(|edge| [corner(edge.from().fix()), corner(edge.to().fix())])
        .collect();
    // If two edges could both take a narrow triangle, the first in this order takes it.
    order::sort_by(&mut edges, |a, b| ascending(*a).cmp(&ascending(*b)));
    (!faces.is_empty()).then_some((faces, edges))
}

/// Returns the line between the two extreme points, with the conditions on it. Returns `None` if
/// all points are equal.
pub(super) fn line(places: &[[f64; 2]]) -> Option<Side> {
    let spread = |axis: usize| {
        let [low, high] = places
            .iter()
            // No coordinate is negative, so 0 is a safe start for the maximum.
            .fold([f64::INFINITY, 0.0], |[low, high], p| [low.min(p[axis]), high.max(p[axis])]);
        high - low
    };
    // Sorts along the axis with the larger extent. Along the other axis, rounding errors could
    // determine the order.
    let along = usize::from(spread(1) > spread(0));
    let ordered = |a: &usize, b: &usize| {
        let (a, b) = (places[*a], places[*b]);
        let across = a[1 - along].total_cmp(&b[1 - along]);
        a[along].total_cmp(&b[along]).then(across)
    };
    let all = 0..places.len();
    let (first, last) = (all.clone().min_by(ordered)?, all.clone().max_by(ordered)?);
    if places[first] == places[last] {
        return None;
    }
    let mut side = Side::new([first, last], places);
    let mut feet: Vec<(f64, usize)> = all.map(|i| (side.foot(places[i]), i)).collect();
    // Feet must ascend strictly from 0 to 1, so conditions at or beyond an end are dropped.
    feet.retain(|(foot, i)| (*foot > 0.0 && *foot < 1.0) || *i == first || *i == last);
    order::sort_by(&mut feet, |a, b| a.0.total_cmp(&b.0));
    feet.dedup_by(|a, b| a.0 == b.0);
    (side.feet, side.conditions) = feet.into_iter().unzip();
    Some(side)
}

/// Finds the narrow triangles along a side, one after another, and assigns them and their
/// conditions to this side.
fn take_slivers(
    index: usize,
    side: &mut Side,
    faces: &mut [Face],
    edges: &Edges,
    places: &[[f64; 2]],
) {
    let ends = side.conditions.iter().copied().zip(side.feet.iter().copied());
    // The conditions that still follow along the side, in reverse order: the next condition is the
    // last element.
    let mut ahead: Vec<(usize, f64)> = ends.rev().collect();
    let mut behind: Vec<(usize, f64)> = ahead.pop().into_iter().collect();
    while let (Some(from), Some(to)) = (behind.last(), ahead.last()) {
        let sliver = edges.beside([from.0, to.0], faces).filter(|(_, condition)| {
            let foot = side.foot(places[*condition]);
            from.1 < foot && foot < to.1 && is_same(places[*condition], side.point(foot))
        });
        match sliver {
            Some((face, condition)) => {
                faces[face].side = Some(index);
                ahead.push((condition, side.foot(places[condition])));
            }
            None => behind.extend(ahead.pop()),
        }
    }
    (side.conditions, side.feet) = behind.into_iter().unzip();
}

/// The triangles at each edge.
struct Edges(Vec<([usize; 2], usize)>);

impl Edges {
    fn new(faces: &[Face]) -> Self {
        let edges = |(i, face): (usize, &Face)| {
            let [a, b, c] = face.corners;
            [[a, b], [b, c], [c, a]].map(|ends| (ascending(ends), i))
        };
        let mut edges: Vec<_> = faces.iter().enumerate().flat_map(edges).collect();
        order::sort(&mut edges);
        Self(edges)
    }

    /// Returns a triangle at an edge that is not yet assigned to a side, and its third corner.
    fn beside(&self, ends: [usize; 2], faces: &[Face]) -> Option<(usize, usize)> {
        let edge = ascending(ends);
        let first = self.0.partition_point(|(other, _)| *other < edge);
        let over = self.0[first..].iter().take_while(|(other, _)| *other == edge);
        let (_, face) = over.into_iter().find(|(_, face)| faces[*face].side.is_none())?;
        let third = faces[*face].corners.into_iter().find(|c| !ends.contains(c))?;
        Some((*face, third))
    }
}

fn ascending([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

fn is_same(a: [f64; 2], b: [f64; 2]) -> bool {
    Condition::is_same(a[0], b[0]) && Condition::is_same(a[1], b[1])
}
