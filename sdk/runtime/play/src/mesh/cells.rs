//! Chooses one triangulation where several are possible. Several triangulations are possible if
//! four or more conditions lie on one circle, such as the four corners of a cell in a grid.
//!
//! Four points on a circle have two Delaunay triangulations. The edge between two triangles is
//! undecided if the two angles opposite to this edge sum to half a turn. Triangles joined by
//! undecided edges form one cell. The cell is divided into a fan of triangles from its first
//! condition. Because the angles do not depend on the order of the conditions, the result does not
//! depend on this order either. For the same reason, the result is the same for every initial
//! triangulation.

use std::collections::BTreeMap;

use htex_dsp::order;

use super::area;

/// The sum of two opposite angles counts as half a turn if it deviates by at most this, radians.
const ON_CIRCLE: f64 = 1e-9;

/// Corners of a triangle, counterclockwise.
type Corners = [usize; 3];

/// Returns the triangles, with each cell replaced by a fan from its lowest index. `places` are in
/// ascending order of their first coordinate, then their second.
///
/// A cell keeps its own triangles if a triangle of the fan would be turned over. This occurs only
/// on the hull, where rounding bends a line. Such triangles are not used for interpolation.
pub(super) fn fanned(triangles: &[Corners], places: &[[f64; 2]]) -> Vec<Corners> {
    let mut fanned = Vec::with_capacity(triangles.len());
    for cell in cells(triangles, places).into_values() {
        let own = || cell.iter().map(|i| triangles[*i]);
        match fan(own(), places) {
            Some(fan) => fanned.extend(fan),
            None => fanned.extend(own()),
        }
    }
    fanned
}

/// Returns the triangles of each cell, keyed by the lowest index in the cell.
fn cells(triangles: &[Corners], places: &[[f64; 2]]) -> BTreeMap<usize, Vec<usize>> {
    // Union-find: two triangles at an undecided edge get the same root.
    let mut parent: Vec<usize> = (0..triangles.len()).collect();
    for [(a, i), (b, k)] in neighbours(triangles) {
        let opposite = [(triangles[i], a), (triangles[k], b)].map(|(corners, edge)| {
            let corner = corners.into_iter().find(|c| !edge.contains(c));
            places[corner.unwrap_or(edge[0])]
        });
        if are_on_a_circle(a.map(|c| places[c]), opposite) {
            let (i, k) = (root(&mut parent, i), root(&mut parent, k));
            // The lowest index becomes the root, so cells do not depend on the order of the edges.
            parent[i.max(k)] = i.min(k);
        }
    }
    let mut cells: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for i in 0..triangles.len() {
        cells.entry(root(&mut parent, i)).or_default().push(i);
    }
    cells
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// The directed edges of a triangle.
fn edges([a, b, c]: Corners) -> [[usize; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Returns each edge that two triangles share, as two entries, one for each triangle. An entry
/// holds the edge in the direction of its triangle, and the index of the triangle.
fn neighbours(triangles: &[Corners]) -> Vec<[([usize; 2], usize); 2]> {
    let directed = |(i, corners): (usize, &Corners)| edges(*corners).map(|edge| (edge, i));
    let mut all: Vec<_> = triangles.iter().enumerate().flat_map(directed).collect();
    let key = |([a, b], i): &([usize; 2], usize)| ([*a.min(b), *a.max(b)], *i);
    order::sort_by(&mut all, |a, b| key(a).cmp(&key(b)));
    let pairs = all.windows(2);
    pairs
        .filter(|pair| pair[0].0 == [pair[1].0[1], pair[1].0[0]])
        .map(|pair| [pair[0], pair[1]])
        .collect()
}

/// Returns whether the angles of two triangles opposite to their common edge sum to half a turn.
fn are_on_a_circle(edge: [[f64; 2]; 2], opposite: [[f64; 2]; 2]) -> bool {
    let angle = |at: [f64; 2], [from, to]: [[f64; 2]; 2]| {
        let [u, v] = [from, to].map(|p| [p[0] - at[0], p[1] - at[1]]);
        (u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])
    };
    let (sin_a, cos_a) = angle(opposite[0], edge);
    let (sin_b, cos_b) = angle(opposite[1], [edge[1], edge[0]]);
    // Sine and cosine of the sum of the angles, both multiplied by the same lengths, which cancel
    // below. The cosine is negative near half a turn.
    let (sin, cos) = (sin_a * cos_b + cos_a * sin_b, cos_a * cos_b - sin_a * sin_b);
    sin.abs() <= -ON_CIRCLE * cos
}

/// Returns the fan of a cell, or `None` if one of the fan's triangles would be turned over.
fn fan(cell: impl Iterator<Item = Corners>, places: &[[f64; 2]]) -> Option<Vec<Corners>> {
    let all: Vec<[usize; 2]> = cell.flat_map(edges).collect();
    let mut inner: Vec<[usize; 2]> = all.iter().map(|[a, b]| [*b, *a]).collect();
    order::sort(&mut inner);
    let is_outer = |edge: &&[usize; 2]| inner.binary_search(edge).is_err();
    let mut next = BTreeMap::new();
    next.extend(all.iter().filter(is_outer).map(|[a, b]| (*a, *b)));
    let apex = *next.keys().next()?;
    let mut fan = Vec::with_capacity(next.len());
    let mut from = *next.get(&apex)?;
    while let Some(to) = next.get(&from).filter(|to| **to != apex) {
        fan.push([apex, from, *to]);
        from = *to;
    }
    let is_upright = |[a, b, c]: &Corners| area(places[*a], places[*b], places[*c]) > 0.0;
    // If the outline visits a condition twice, `next` has lost an edge, and the fan is too short.
    (3 * fan.len() == all.len() && fan.iter().all(is_upright)).then_some(fan)
}
