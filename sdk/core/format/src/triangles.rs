//! Checks whether a player can interpolate in the triangles that a representation stores.
//!
//! If the triangles cover the convex hull of the conditions exactly once, the interpolated
//! parameters change continuously with the motion. In this case no motion lies in two triangles,
//! and every motion outside the hull has exactly one nearest point in the hull.
//!
//! Testing all pairs of triangles would take time proportional to the square of their number. The
//! tests here take little more time than sorting the triangles. They put the corners of each
//! triangle in counterclockwise order, and check three things:
//!
//! - Each directed edge belongs to only one triangle.
//! - The edges that belong to only one triangle form one outline.
//! - The outline turns left at each corner and goes around once.
//!
//! These tests are sufficient for the following reason. The edges between two triangles cancel each
//! other. Therefore, the number of triangles that cover a point equals the number of turns of the
//! outline around the point. The outline goes once around each point inside it, and not around any
//! point outside it. So exactly one triangle covers each point inside the outline, and no triangle
//! covers a point outside.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

/// Three conditions, as indices into [`crate::Representation::at`].
pub type Triangle = [usize; 3];

/// The reason why a player cannot interpolate in the stored triangles.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TrianglesError {
    /// A corner of the triangle is not a valid index into `at`.
    #[error("corner {corner} does not exist; `at` has {conditions} elements, counted from 0")]
    Corner { triangle: usize, corner: usize, conditions: usize },
    /// A triangle has the same corner twice.
    #[error("corner {corner} is there twice; a triangle has three different corners")]
    Twice { triangle: usize, corner: usize },
    /// The speed or the force of a condition is unknown.
    #[error(
        "element {condition} of `at` has no known speed or force; state both, or leave `triangles` out"
    )]
    Unknown { condition: usize },
    /// The corners of a triangle lie on a line.
    #[error("the corners lie on a line; leave the triangle out")]
    Flat { triangle: usize },
    /// Two triangles lie on the same side of their common edge.
    #[error(
        "the triangle overlaps triangle {other}, on the same side of the edge from {from} to {to}; remove one of them"
    )]
    Edge { triangle: usize, other: usize, from: usize, to: usize },
    /// A condition is not a corner of any triangle.
    #[error(
        "element {condition} of `at` is the corner of no triangle; add triangles to it, or remove it"
    )]
    Unreached { condition: usize },
    /// The triangles have gaps, touch only in a corner, overlap, or do not cover the whole hull.
    #[error(
        "the triangles do not cover the hull of the conditions once (at element {condition} of `at`); close the gap there, or remove \
         what overlaps"
    )]
    Outline { condition: usize },
}

impl TrianglesError {
    /// Returns the index of the triangle that breaks a rule, or `None` if the rule concerns all
    /// triangles together.
    pub fn triangle(&self) -> Option<usize> {
        match self {
            Self::Corner { triangle, .. }
            | Self::Twice { triangle, .. }
            | Self::Flat { triangle }
            | Self::Edge { triangle, .. } => Some(*triangle),
            Self::Unknown { .. } | Self::Unreached { .. } | Self::Outline { .. } => None,
        }
    }
}

/// Flatness limit. A triangle counts as flat if twice its area, divided by the square of its
/// longest side, is at most this number.
const FLAT: f64 = 1e-9;

/// Checks triangles between conditions. Each condition is a speed (mm/s) and a force (newtons),
/// both finite and not negative. An empty list is valid, because an asset need not store triangles.
///
/// ```
/// use htex_format::check_triangles;
///
/// let square = [[40.0, 0.3], [160.0, 0.3], [40.0, 1.2], [160.0, 1.2]];
/// assert!(check_triangles(&square, &[[0, 1, 3], [0, 3, 2]]).is_ok());
/// // Both lie below the diagonal.
/// assert!(check_triangles(&square, &[[0, 1, 3], [0, 1, 2]]).is_err());
/// ```
///
/// # Errors
/// Returns an error if the triangles break a rule of section 2 of `spec/htex-1.md`. The error is
/// the first broken rule, in the order of that section.
pub fn check_triangles(
    conditions: &[[f64; 2]],
    triangles: &[Triangle],
) -> Result<(), TrianglesError> {
    if triangles.is_empty() {
        return Ok(());
    }
    check_corners(conditions.len(), triangles)?;
    // Speeds in mm/s are hundreds of times larger than forces in newtons. Without a common scale,
    // good triangles would count as flat.
    let places = relative(conditions);
    let upright = upright(&places, triangles)?;
    let outline = outline(&upright)?;
    let mut used = BTreeSet::new();
    used.extend(triangles.iter().flatten().copied());
    match (0..conditions.len()).find(|condition| !used.contains(condition)) {
        Some(condition) => Err(TrianglesError::Unreached { condition }),
        None => check_outline(&places, &outline),
    }
}

/// Checks that each triangle has three different corners, and that each corner is an index below
/// the number of conditions.
pub(crate) fn check_corners(
    conditions: usize,
    triangles: &[Triangle],
) -> Result<(), TrianglesError> {
    for (triangle, corners) in triangles.iter().enumerate() {
        let [a, b, c] = *corners;
        if let Some(corner) = corners.iter().copied().find(|i| *i >= conditions) {
            return Err(TrianglesError::Corner { triangle, corner, conditions });
        }
        if a == b || b == c || c == a {
            let corner = if a == b { a } else { c };
            return Err(TrianglesError::Twice { triangle, corner });
        }
    }
    Ok(())
}

/// Divides each axis by its greatest value.
fn relative(conditions: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let greatest = [0, 1].map(|axis| conditions.iter().map(|c| c[axis]).fold(0.0, f64::max));
    let part = |x: f64, greatest: f64| if greatest > 0.0 { x / greatest } else { 0.0 };
    let place = |c: &[f64; 2]| [part(c[0], greatest[0]), part(c[1], greatest[1])];
    conditions.iter().map(place).collect()
}

/// Returns the triangles with their corners in counterclockwise order.
fn upright(places: &[[f64; 2]], triangles: &[Triangle]) -> Result<Vec<Triangle>, TrianglesError> {
    let turned = |(triangle, corners): (usize, &Triangle)| {
        let [a, b, c] = *corners;
        let corners = corners.map(|i| places[i]);
        match Turn::around(corners) {
            Turn::Left => Ok([a, b, c]),
            Turn::Right => Ok([a, c, b]),
            Turn::Flat => Err(TrianglesError::Flat { triangle }),
        }
    };
    triangles.iter().enumerate().map(turned).collect()
}

/// The direction in which three points turn.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Turn {
    Left,
    Right,
    Flat,
}

impl Turn {
    fn around([a, b, c]: [[f64; 2]; 3]) -> Self {
        let longest2 = distance2(a, b).max(distance2(b, c)).max(distance2(c, a));
        let area = cross(between(a, b), between(a, c));
        // The condition is written so that a triangle counts as flat unless it is known not to be
        // flat. Two equal points, and numbers whose products are too small to represent, also count
        // as flat.
        if area > FLAT * longest2 {
            Self::Left
        } else if -area > FLAT * longest2 {
            Self::Right
        } else {
            Self::Flat
        }
    }
}

fn between(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [b[0] - a[0], b[1] - a[1]]
}

fn cross(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

fn distance2(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = between(a, b);
    x * x + y * y
}

/// Returns the edges that only one triangle has. The key of an edge is the corner at which it
/// begins.
fn outline(upright: &[Triangle]) -> Result<BTreeMap<usize, usize>, TrianglesError> {
    let mut owners = BTreeMap::new();
    for (triangle, [a, b, c]) in upright.iter().enumerate() {
        for edge in [[*a, *b], [*b, *c], [*c, *a]] {
            if let Some(other) = owners.insert(edge, triangle) {
                let [from, to] = edge;
                return Err(TrianglesError::Edge { triangle, other, from, to });
            }
        }
    }
    let mut outline = BTreeMap::new();
    let outer = owners.keys().filter(|[from, to]| !owners.contains_key(&[*to, *from]));
    for [from, to] in outer {
        if outline.insert(*from, *to).is_some() {
            return Err(TrianglesError::Outline { condition: *from });
        }
    }
    Ok(outline)
}

/// Checks that the edges form a single outline, and that the outline is a convex polygon.
fn check_outline(
    places: &[[f64; 2]],
    outline: &BTreeMap<usize, usize>,
) -> Result<(), TrianglesError> {
    let Some((&first, _)) = outline.first_key_value() else {
        return Ok(());
    };
    let next = |corner: usize| outline.get(&corner).copied().unwrap_or(first);
    let (mut corner, mut around, mut passed) = (first, 0.0, BTreeSet::new());
    while passed.insert(corner) {
        let three = [corner, next(corner), next(next(corner))].map(|i| places[i]);
        // An outline may continue straight at a corner, because conditions may lie on a side of the
        // hull.
        if Turn::around(three) == Turn::Right {
            let condition = next(corner);
            return Err(TrianglesError::Outline { condition });
        }
        let [u, v] = [between(three[0], three[1]), between(three[1], three[2])];
        around += libm::atan2(cross(u, v), u[0] * v[0] + u[1] * v[1]);
        corner = next(corner);
    }
    // A corner that was not passed lies on a second outline (a gap or a separate part). If the sum
    // of the angles exceeds one turn, the outline goes around more than once.
    let apart = outline.keys().copied().find(|other| !passed.contains(other));
    // The sum is a whole number of turns apart from rounding, so the limit lies between one turn
    // and two.
    match apart.or_else(|| (around > 1.5 * TAU).then_some(first)) {
        Some(condition) => Err(TrianglesError::Outline { condition }),
        None => Ok(()),
    }
}
