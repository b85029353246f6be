//! From known conditions to triangles, and to the edges of their hull.

use htex_format::Condition;
use spade::{DelaunayTriangulation, Point2, Triangulation};

use super::axis::Axis;
use super::{Face, Mesh, Side};

pub(super) fn mesh(conditions: &[[f64; 2]]) -> Mesh {
    let (mut axes, mut places) = placed(conditions, true);
    if !are_apart(&places) {
        (axes, places) = placed(conditions, false);
    }
    let (mut faces, mut sides) = match triangulate(&places) {
        Some((faces, edges)) => (
            faces,
            edges.iter().map(|e| Side::new(*e, &places)).collect(),
        ),
        None => (vec![], line(&places).into_iter().collect::<Vec<_>>()),
    };
    for (i, side) in sides.iter_mut().enumerate() {
        take_slivers(i, side, &mut faces, &places);
    }
    Mesh {
        conditions: conditions.to_vec(),
        axes,
        faces,
        sides,
    }
}

/// Both axes, and the places of all conditions.
fn placed(conditions: &[[f64; 2]], merged: bool) -> ([Axis; 2], Vec<[f64; 2]>) {
    let values = |axis: usize| conditions.iter().map(|c| c[axis]).collect();
    let [speed, force] = [0, 1].map(|axis| Axis::new(values(axis), merged));
    let place = |c: &[f64; 2]| [speed.place(c[0]), force.place(c[1])];
    let places = conditions.iter().map(place).collect();
    ([speed, force], places)
}

/// Whether no two conditions stand at one place.
fn are_apart(places: &[[f64; 2]]) -> bool {
    let mut sorted = places.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.windows(2).all(|pair| pair[0] != pair[1])
}

type Triangles = (Vec<Face>, Vec<[usize; 2]>);

/// Triangles and hull edges; none if the points do not span a triangle.
fn triangulate(places: &[[f64; 2]]) -> Option<Triangles> {
    let mut mesh = DelaunayTriangulation::<Point2<f64>>::new();
    let mut index = Vec::new();
    for (i, p) in places.iter().enumerate() {
        let handle = mesh.insert(Point2::new(p[0], p[1])).ok()?;
        if handle.index() == index.len() {
            index.push(i);
        }
    }
    let face = |corners: [usize; 3]| Face {
        corners,
        places: corners.map(|i| places[i]),
        side: None,
    };
    let faces: Vec<Face> = mesh
        .inner_faces()
        .map(|f| face(f.vertices().map(|v| index[v.fix().index()])))
        .collect();
    let corner = |v: spade::handles::FixedVertexHandle| index[v.index()];
    let edges = mesh
        .convex_hull()
        .map(|edge| [corner(edge.from().fix()), corner(edge.to().fix())])
        .collect();
    (!faces.is_empty()).then_some((faces, edges))
}

/// Points on a line; none where there are not two places.
fn line(places: &[[f64; 2]]) -> Option<Side> {
    let ordered = |a: &usize, b: &usize| {
        let (a, b) = (places[*a], places[*b]);
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    };
    let all = 0..places.len();
    let (first, last) = (all.clone().min_by(ordered)?, all.clone().max_by(ordered)?);
    if places[first] == places[last] {
        return None;
    }
    let mut side = Side::new([first, last], places);
    let mut feet: Vec<(f64, usize)> = all.map(|i| (side.foot(places[i]), i)).collect();
    feet.retain(|(foot, i)| (*foot > 0.0 && *foot < 1.0) || *i == first || *i == last);
    feet.sort_by(|a, b| a.0.total_cmp(&b.0));
    feet.dedup_by(|a, b| a.0 == b.0);
    (side.feet, side.conditions) = feet.into_iter().unzip();
    Some(side)
}

/// Gives a side the slivers that lie on it, one behind the other, and their conditions.
fn take_slivers(index: usize, side: &mut Side, faces: &mut [Face], places: &[[f64; 2]]) {
    let mut link = 0;
    while link + 1 < side.conditions.len() {
        let ends = [side.conditions[link], side.conditions[link + 1]];
        let Some((face, condition)) = beside(faces, ends) else {
            link += 1;
            continue;
        };
        let foot = side.foot(places[condition]);
        let between = side.feet[link] < foot && foot < side.feet[link + 1];
        if between && is_same(places[condition], side.at(foot)) {
            faces[face].side = Some(index);
            side.conditions.insert(link + 1, condition);
            side.feet.insert(link + 1, foot);
        } else {
            link += 1;
        }
    }
}

/// A triangle over an edge that no side has yet, and its third corner.
fn beside(faces: &[Face], ends: [usize; 2]) -> Option<(usize, usize)> {
    let third = |face: &Face| {
        let has = |end: &usize| face.corners.contains(end);
        let third = face.corners.iter().find(|c| !ends.contains(c));
        third.copied().filter(|_| ends.iter().all(has))
    };
    let free = |(i, face): (usize, &Face)| match face.side {
        None => Some((i, third(face)?)),
        Some(_) => None,
    };
    faces.iter().enumerate().find_map(free)
}

fn is_same(a: [f64; 2], b: [f64; 2]) -> bool {
    Condition::is_same(a[0], b[0]) && Condition::is_same(a[1], b[1])
}
