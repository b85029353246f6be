//! Makes a mesh from the triangles that an asset stores. [`htex_format::check_triangles`] must have
//! accepted them.

use std::collections::BTreeSet;

use htex_format::Triangle;

use super::triangulation::{placed, sorted};
use super::{Face, Mesh, Side, area};

/// Makes a mesh from valid triangles.
pub(super) fn mesh(conditions: &[[f64; 2]], triangles: &[Triangle]) -> Mesh {
    let (axes, places) = placed(conditions, false);
    let (numbers, places) = sorted(conditions, &places);
    let mut own = vec![0; numbers.len()];
    for (i, number) in numbers.iter().enumerate() {
        own[*number] = i;
    }
    let mut all: Vec<[usize; 3]> = triangles
        .iter()
        .map(|corners| upright(corners.map(|number| own[number]), &places))
        .collect();
    // Sorted, so that the mesh does not depend on the order in which the triangles are stored.
    htex_dsp::order::sort(&mut all);
    let face = |corners: &[usize; 3]| Face {
        corners: *corners,
        places: corners.map(|i| places[i]),
        side: None,
    };
    let sides = outer(&all);
    Mesh {
        only: places.first().copied().unwrap_or_default(),
        numbers,
        axes,
        faces: all.iter().map(face).collect(),
        sides: sides.map(|ends| Side::new(ends, &places)).collect(),
    }
}

/// Returns the corners counterclockwise, starting with the lowest index.
fn upright([a, b, c]: [usize; 3], places: &[[f64; 2]]) -> [usize; 3] {
    let [a, b, c] = if area(places[a], places[b], places[c]) < 0.0 { [a, c, b] } else { [a, b, c] };
    let first = a.min(b).min(c);
    if first == a {
        [a, b, c]
    } else if first == b {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Returns the edges that belong to only one triangle, in ascending order.
fn outer(triangles: &[[usize; 3]]) -> impl Iterator<Item = [usize; 2]> {
    let edges = |[a, b, c]: &[usize; 3]| [[*a, *b], [*b, *c], [*c, *a]];
    let (mut all, mut neighbours) = (BTreeSet::new(), BTreeSet::new());
    all.extend(triangles.iter().flat_map(edges));
    neighbours.extend(all.iter().map(|[from, to]: &[usize; 2]| [*to, *from]));
    all.into_iter().filter(move |edge| !neighbours.contains(edge))
}
