//! Interpolation between recorded conditions (speed and normal force).
//!
//! The recorded conditions are points (speed, force). The mesh divides each axis by its largest
//! value and triangulates the points (Delaunay). The weights of a motion are its barycentric
//! coordinates in its triangle. A motion outside the hull has the weights of the nearest point of
//! the hull. Measured conditions are not exactly aligned, and a grid has several triangulations.
//! Therefore the following rules apply:
//!
//! - Speeds that are equal within [`htex_format::SAME_CONDITION`] count as one speed, and forces
//!   that are equal within this tolerance count as one force (module `axis`).
//! - If there are several Delaunay triangulations, as for a grid, the module `cells` chooses one.
//! - A condition counts as lying on an edge of the hull if it equals its projection on this edge,
//!   within the same tolerance. The narrow triangle between such a condition and the edge is not
//!   used for interpolation. A motion inside this triangle, or outside the hull next to this
//!   triangle, is projected on the edge. The projection then determines the weights.
//!
//! The weights change continuously with the motion. At a recorded condition, only that condition's
//! weight is not zero.
//!
//! An asset may store its own triangles (module `stored`). Weights are then barycentric in the
//! stored triangles, and the rules above do not apply.

mod axis;
mod cells;
mod stored;
#[cfg(test)]
mod tests;
mod triangulation;

use axis::Axis;
use htex_format::{Triangle, TrianglesError};

/// Largest coordinate at which distances to edges are compared, relative to the largest speed and
/// force. A motion farther out is first moved to this distance. Otherwise rounding would hide which
/// edge is nearest.
const FARTHEST: f64 = 1e6;
/// Largest distance from an edge, relative to the largest speed and force, that counts as rounding.
const ON_SIDE: f64 = 1e-9;

/// Conditions with at most this weight are dropped, so that a motion at a recorded condition plays
/// that condition's parameters without interpolation.
const NO_WEIGHT: f64 = 1e-12;

/// The weights with which up to three conditions are mixed for a motion. The weights sum to one.
/// The weights are in ascending order of their conditions' speeds and, at equal speeds, in
/// ascending order of the forces.
///
/// ```
/// use htex::play::Mesh;
/// let weights = Mesh::new(&[[40.0, 0.4], [160.0, 0.4]]).weights(70.0, 0.4);
/// assert_eq!(weights.iter().collect::<Vec<_>>(), [(0, 0.75), (1, 0.25)]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    pub(crate) condition: [usize; 3],
    pub(crate) weight: [f64; 3],
    pub(crate) count: usize,
}

impl Weights {
    fn one(condition: usize) -> Self {
        Self { condition: [condition, 0, 0], weight: [1.0, 0.0, 0.0], count: 1 }
    }

    /// Iterates over pairs of a condition's index and its weight.
    pub fn iter(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        (0..self.count).map(|i| (self.condition[i], self.weight[i]))
    }

    /// Returns the weights above [`NO_WEIGHT`] in ascending order of the sorted conditions.
    /// Replaces the sorted indices by the caller's numbers.
    fn numbered(self, numbers: &[usize]) -> Self {
        let mut parts = [0, 1, 2].map(|i| (self.condition[i], self.weight[i]));
        // Insertion sort: there are at most three parts, and this must not allocate.
        for i in 1..self.count {
            let mut at = i;
            while at > 0 && parts[at].0 < parts[at - 1].0 {
                parts.swap(at, at - 1);
                at -= 1;
            }
        }
        let mut kept = Self { count: 0, ..self };
        for (condition, weight) in parts[..self.count].iter().filter(|(_, w)| *w > NO_WEIGHT) {
            kept.condition[kept.count] = numbers.get(*condition).copied().unwrap_or_default();
            kept.weight[kept.count] = *weight;
            kept.count += 1;
        }
        kept
    }
}

/// A triangulation of recorded conditions, which gives the weights for any motion. Section 4 of
/// `spec/htex-playing-1.md` states the rules of the triangulation.
///
/// ```
/// use htex_play::Mesh;
///
/// let mesh = Mesh::new(&[[40.0, 0.3], [160.0, 0.3], [40.0, 1.2]]);
/// let weights: Vec<(usize, f64)> = mesh.weights(100.0, 0.3).iter().collect();
/// assert_eq!(weights, [(0, 0.5), (1, 0.5)]);
/// assert!(mesh.surrounds(50.0, 0.4) && !mesh.surrounds(160.0, 1.2));
/// ```
#[derive(Debug, Clone)]
pub struct Mesh {
    /// The caller's number of each condition. All other indices refer to the conditions sorted in
    /// ascending order of their coordinates.
    numbers: Vec<usize>,
    /// Coordinates of the first condition, used if the mesh has no sides because it has only this
    /// point.
    only: [f64; 2],
    axes: [Axis; 2],
    faces: Vec<Face>,
    sides: Vec<Side>,
}

/// A triangle whose corners are three conditions.
#[derive(Debug, Clone, PartialEq)]
struct Face {
    corners: [usize; 3],
    places: [[f64; 2]; 3],
    /// The edge of the hull to which this triangle belongs, if it is a narrow triangle.
    side: Option<usize>,
}

/// An edge of the hull with all conditions on it. If all conditions lie on one line, this line.
#[derive(Debug, Clone, PartialEq)]
struct Side {
    from: [f64; 2],
    along: [f64; 2],
    /// Conditions in order along the edge, including both ends.
    conditions: Vec<usize>,
    /// Position of each condition's projection on the edge, from 0 for the first to 1 for the last
    /// condition. Strictly ascending.
    feet: Vec<f64>,
}

impl Mesh {
    /// Makes a mesh of one or more points: speed (mm/s) and force (newtons). Speeds and forces must
    /// be finite and not negative.
    pub fn new(conditions: &[[f64; 2]]) -> Self {
        triangulation::mesh(conditions)
    }

    /// Makes a mesh from points and the triangles that an asset stores. Without triangles, the
    /// result is the same as from [`Self::new`].
    ///
    /// # Errors
    /// Returns an error if [`htex_format::check_triangles`] finds that the triangles are invalid.
    pub fn with_triangles(
        conditions: &[[f64; 2]],
        triangles: &[Triangle],
    ) -> Result<Self, TrianglesError> {
        if triangles.is_empty() {
            return Ok(Self::new(conditions));
        }
        htex_format::check_triangles(conditions, triangles)?;
        Ok(stored::mesh(conditions, triangles))
    }

    /// Returns the weights of the conditions at a motion. Does not allocate.
    pub fn weights(&self, speed_mm_s: f64, force_n: f64) -> Weights {
        self.locate(speed_mm_s, force_n).0
    }

    /// Returns the weights at a motion, and the nearest motion (speed, force) within the mesh. For
    /// a motion inside the mesh, this is the motion itself. Does not allocate.
    pub(crate) fn locate(&self, speed_mm_s: f64, force_n: f64) -> (Weights, [f64; 2]) {
        let asked = [speed_mm_s, force_n];
        let q = [0, 1].map(|axis| self.axes[axis].place(asked[axis]));
        let inside = self.faces.iter().find_map(|face| self.within(face, q));
        if let Some(weights) = inside {
            return (weights.numbered(&self.numbers), asked);
        }
        let (weights, place) = self.nearest(q);
        let nearest = [0, 1].map(|axis| self.axes[axis].value(place[axis], asked[axis]));
        (weights.numbered(&self.numbers), nearest)
    }

    /// Returns whether a motion lies inside the mesh or on its edge. If all conditions lie on one
    /// line, only motions on the line between the conditions count as inside.
    pub fn surrounds(&self, speed_mm_s: f64, force_n: f64) -> bool {
        let [speed, force] = &self.axes;
        let q = [speed.place(speed_mm_s), force.place(force_n)];
        let on_side = |side: &Side| side.distance2(q) <= ON_SIDE * ON_SIDE;
        self.faces.iter().any(|face| self.within(face, q).is_some())
            || self.sides.iter().any(on_side)
    }

    /// Iterates over the triangles. Each triangle is given as three indices into the points from
    /// which the mesh was made.
    pub fn triangles(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let own = |corners: [usize; 3]| corners.map(|i| self.numbers[i]);
        self.faces.iter().map(move |face| own(face.corners))
    }

    /// Returns the weights at a point if it lies in a triangle or on its edge.
    fn within(&self, face: &Face, q: [f64; 2]) -> Option<Weights> {
        let [a, b, c] = face.places;
        // For their common edge, two triangles compute areas of equal size and opposite sign. So
        // rounding cannot put a motion outside both triangles.
        let areas = [area(q, b, c), area(q, c, a), area(q, a, b)];
        if areas.iter().any(|area| *area < 0.0) {
            return None;
        }
        if let Some(side) = face.side {
            return Some(self.sides[side].weights(q));
        }
        let sum: f64 = areas.iter().sum();
        // A triangle that rounding made flat has no weights.
        (sum > 0.0).then(|| Weights {
            condition: face.corners,
            weight: areas.map(|area| area / sum),
            count: 3,
        })
    }

    /// Returns the weights of the nearest point of the hull, and that point.
    fn nearest(&self, q: [f64; 2]) -> (Weights, [f64; 2]) {
        let size = q[0].abs().max(q[1].abs());
        // Moving the point closer keeps its direction. At this distance, the direction decides
        // which edge is nearest.
        let q = if size > FARTHEST { q.map(|x| x / size * FARTHEST) } else { q };
        let distance = |side: &Side| side.distance2(q);
        let nearest = self.sides.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let only = || (Weights::one(0), self.only);
        nearest
            .map_or_else(only, |side| (side.weights(q), side.point(side.foot(q).clamp(0.0, 1.0))))
    }
}

impl Side {
    /// Makes a side that has conditions only at its ends.
    fn new(ends: [usize; 2], places: &[[f64; 2]]) -> Self {
        let [from, to] = ends.map(|i| places[i]);
        Self {
            from,
            along: [to[0] - from[0], to[1] - from[1]],
            conditions: ends.to_vec(),
            feet: vec![0.0, 1.0],
        }
    }

    /// Returns the position of a point's projection on the line through the edge: 0 at its start, 1
    /// at its end.
    fn foot(&self, q: [f64; 2]) -> f64 {
        let [x, y] = self.along;
        ((q[0] - self.from[0]) * x + (q[1] - self.from[1]) * y) / (x * x + y * y)
    }

    fn point(&self, place: f64) -> [f64; 2] {
        [0, 1].map(|axis| self.from[axis] + place * self.along[axis])
    }

    /// Returns the squared distance of a point from the edge.
    fn distance2(&self, q: [f64; 2]) -> f64 {
        let [x, y] = self.point(self.foot(q).clamp(0.0, 1.0));
        (x - q[0]) * (x - q[0]) + (y - q[1]) * (y - q[1])
    }

    /// Returns the weights at a point's projection on the edge.
    fn weights(&self, q: [f64; 2]) -> Weights {
        let place = self.foot(q).clamp(0.0, 1.0);
        let last = self.feet.len() - 1;
        // The first and last foot are the clamped ends 0 and 1, so only the inner ones need a
        // search.
        let inner = &self.feet[1..last];
        let behind = 1 + inner.partition_point(|foot| *foot < place);
        let (from, to) = (self.feet[behind - 1], self.feet[behind]);
        let part = (place - from) / (to - from);
        Weights {
            condition: [self.conditions[behind - 1], self.conditions[behind], 0],
            weight: [1.0 - part, part, 0.0],
            count: 2,
        }
    }
}

/// Returns twice the signed area of a triangle, positive if it is counterclockwise. Swapping the
/// last two corners changes only the sign, exactly.
fn area(q: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - q[0]) * (c[1] - q[1]) - (b[1] - q[1]) * (c[0] - q[0])
}
