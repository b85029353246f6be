//! Interpolation between exploration conditions: barycentric in the Delaunay triangulation of the
//! known (speed, force) points, clamped to their hull.

use spade::{DelaunayTriangulation, Point2, Triangulation};

/// Weights of up to three conditions, summing to one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Weights {
    pub(crate) condition: [usize; 3],
    pub(crate) weight: [f64; 3],
    pub(crate) count: usize,
}

impl Weights {
    fn one(condition: usize) -> Self {
        Self {
            condition: [condition, 0, 0],
            weight: [1.0, 0.0, 0.0],
            count: 1,
        }
    }

    /// The pairs of condition and weight.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        (0..self.count).map(|i| (self.condition[i], self.weight[i]))
    }

    /// Leaves out conditions without weight, so that a known condition is played as it is.
    fn without_zeros(self) -> Self {
        let mut kept = Self { count: 0, ..self };
        for (condition, weight) in self.iter().filter(|(_, w)| *w > 0.0) {
            kept.condition[kept.count] = condition;
            kept.weight[kept.count] = weight;
            kept.count += 1;
        }
        kept
    }
}

/// The known conditions.
#[derive(Debug, Clone)]
pub(crate) struct Mesh {
    points: Vec<[f64; 2]>,
    /// What makes both axes comparable.
    scale: [f64; 2],
    triangles: Vec<[usize; 3]>,
    /// Edges of the hull; for points on a line, from each to the next.
    edges: Vec<[usize; 2]>,
}

impl Mesh {
    /// A mesh over points of (speed, force), of which there is at least one.
    pub(crate) fn new(conditions: &[[f64; 2]]) -> Self {
        let scale = [0, 1].map(|axis| {
            let largest = conditions.iter().map(|c| c[axis].abs()).fold(0.0, f64::max);
            if largest > 0.0 { 1.0 / largest } else { 1.0 }
        });
        let points: Vec<[f64; 2]> = conditions
            .iter()
            .map(|c| [c[0] * scale[0], c[1] * scale[1]])
            .collect();
        let (triangles, edges) = triangulate(&points).unwrap_or_else(|| (vec![], chain(&points)));
        Self {
            points,
            scale,
            triangles,
            edges,
        }
    }

    /// Weights at a motion. Does not allocate.
    pub(crate) fn weights(&self, speed_mm_s: f64, force_n: f64) -> Weights {
        let q = [speed_mm_s * self.scale[0], force_n * self.scale[1]];
        let inside = self.triangles.iter().find_map(|t| self.in_triangle(*t, q));
        inside.unwrap_or_else(|| self.nearest(q)).without_zeros()
    }

    fn in_triangle(&self, corners: [usize; 3], q: [f64; 2]) -> Option<Weights> {
        let [a, b, c] = corners.map(|i| self.points[i]);
        let area = cross(a, b, c);
        let weight = [
            cross(q, b, c) / area,
            cross(a, q, c) / area,
            cross(a, b, q) / area,
        ];
        let inside = weight.iter().all(|w| *w >= 0.0);
        inside.then_some(Weights {
            condition: corners,
            weight,
            count: 3,
        })
    }

    /// The nearest point of the hull's edges.
    fn nearest(&self, q: [f64; 2]) -> Weights {
        let on_edge = |&[i, j]: &[usize; 2]| {
            let (a, b) = (self.points[i], self.points[j]);
            let along = [b[0] - a[0], b[1] - a[1]];
            let length2 = along[0] * along[0] + along[1] * along[1];
            let dot = (q[0] - a[0]) * along[0] + (q[1] - a[1]) * along[1];
            let t = (dot / length2).clamp(0.0, 1.0);
            let off = [a[0] + t * along[0] - q[0], a[1] + t * along[1] - q[1]];
            let weights = Weights {
                condition: [i, j, 0],
                weight: [1.0 - t, t, 0.0],
                count: 2,
            };
            (off[0] * off[0] + off[1] * off[1], weights)
        };
        let nearer = |a: (f64, Weights), b: (f64, Weights)| if b.0 < a.0 { b } else { a };
        let best = self.edges.iter().map(on_edge).reduce(nearer);
        best.map_or(Weights::one(0), |(_, weights)| weights)
    }
}

/// Twice the signed area of a triangle.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

type Faces = (Vec<[usize; 3]>, Vec<[usize; 2]>);

/// Triangles and hull edges; none if the points do not span a triangle.
fn triangulate(points: &[[f64; 2]]) -> Option<Faces> {
    let mut mesh = DelaunayTriangulation::<Point2<f64>>::new();
    let mut index = Vec::new();
    for (i, p) in points.iter().enumerate() {
        let handle = mesh.insert(Point2::new(p[0], p[1])).ok()?;
        if handle.index() == index.len() {
            index.push(i);
        }
    }
    let triangles: Vec<[usize; 3]> = mesh
        .inner_faces()
        .map(|face| face.vertices().map(|v| index[v.fix().index()]))
        .collect();
    let corner = |v: spade::handles::FixedVertexHandle| index[v.index()];
    let edges = mesh
        .convex_hull()
        .map(|edge| [corner(edge.from().fix()), corner(edge.to().fix())])
        .collect();
    (!triangles.is_empty()).then_some((triangles, edges))
}

/// Points on a line, each joined to the next along it.
fn chain(points: &[[f64; 2]]) -> Vec<[usize; 2]> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (points[a], points[b]);
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    order
        .windows(2)
        .map(|pair| [pair[0], pair[1]])
        .filter(|[a, b]| points[*a] != points[*b])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(mesh: &Mesh, speed: f64, force: f64) -> Vec<(usize, f64)> {
        mesh.weights(speed, force).iter().collect()
    }

    #[test]
    fn corners_edges_middle_and_outside_of_a_square() {
        let square = [[50.0, 0.2], [150.0, 0.2], [50.0, 0.8], [150.0, 0.8]];
        let mesh = Mesh::new(&square);
        for (i, c) in square.iter().enumerate() {
            assert_eq!(at(&mesh, c[0], c[1]), [(i, 1.0)]);
        }
        // Far outside: the nearest corner. Beside an edge: the edge's point.
        assert_eq!(at(&mesh, 1e9, 100.0), [(3, 1.0)]);
        let beside = at(&mesh, 100.0, 0.0);
        assert_eq!(beside.len(), 2);
        assert!(
            beside
                .iter()
                .all(|(i, w)| *i < 2 && (w - 0.5).abs() < 1e-12)
        );
        // Anywhere inside: weights that give back the point.
        for (speed, force) in [(60.0, 0.3), (100.0, 0.5), (149.0, 0.79)] {
            let weights = at(&mesh, speed, force);
            let mean = |axis: usize| {
                weights
                    .iter()
                    .map(|(i, w)| square[*i][axis] * w)
                    .sum::<f64>()
            };
            assert!((mean(0) - speed).abs() < 1e-9 && (mean(1) - force).abs() < 1e-12);
        }
    }

    #[test]
    fn one_condition_and_conditions_on_a_line() {
        assert_eq!(at(&Mesh::new(&[[80.0, 0.4]]), 10.0, 3.0), [(0, 1.0)]);
        let line = Mesh::new(&[[160.0, 0.4], [40.0, 0.4], [80.0, 0.4]]);
        assert_eq!(at(&line, 60.0, 0.4), [(1, 0.5), (2, 0.5)]);
        assert_eq!(at(&line, 0.0, 0.4), [(1, 1.0)]);
    }
}
