//! The distance in decibels between a beta density and the points to fit, and a closed form for the
//! density that is nearest to these points.
//!
//! `ln(density) = (α - 1) ln u + (β - 1) ln(1 - u) + scale` is linear in its three unknowns α, β
//! and scale. Therefore, the nearest density is the solution of a least-squares problem in which α
//! and β are bounded. If a density is very faint at some point, a lower limit replaces its level at
//! this point. The problem is then not linear, and the fit uses a search instead.

use htex_dsp::beta::log_unit;
use htex_dsp::grid::Band;
use htex_dsp::peaks::Peak;

use crate::Profile;

/// Lower limit for points and for densities that are compared in decibels, relative to the largest
/// point or the largest density.
const FAINTEST: f64 = 1e-6;
/// If one minus the squared correlation of `ln u` and `ln(1 - u)` is at most this, the two count as
/// equal.
const SAME: f64 = 1e-9;

/// Returns the alpha and beta between the bounds with the least squared difference in decibels.
/// Returns `None` if the points do not determine alpha and beta, or if the difference at some point
/// is cut off.
pub(crate) fn nearest(points: &[Peak], band: Band, [low, high]: [f64; 2]) -> Option<(f64, f64)> {
    let squares = Squares::new(points, band)?;
    let [low, high] = [low - 1.0, high - 1.0];
    let [a, b] = squares.least([low, high]);
    let found = (a + 1.0, b + 1.0);
    let profile = Profile::new(found.0, found.1, band);
    let densities = || inside(points, band).map(|point| profile.density_at(point.frequency_hz));
    let highest = densities().fold(0.0, f64::max);
    let is_seen = |density: f64| density.is_finite() && density >= FAINTEST * highest;
    (highest > 0.0 && densities().all(is_seen)).then_some(found)
}

/// Sums of products of the centred `ln u` (x), `ln(1 - u)` (y) and logarithmic magnitudes (z).
struct Squares {
    xx: f64,
    xy: f64,
    yy: f64,
    xz: f64,
    yz: f64,
}

impl Squares {
    /// Computes the sums. Returns `None` if there are fewer points than unknowns, or if the points
    /// have too few different frequencies.
    fn new(points: &[Peak], band: Band) -> Option<Self> {
        let faintest = FAINTEST * inside(points, band).map(|p| p.magnitude).fold(0.0, f64::max);
        let row = |point: &Peak| {
            let u = log_unit(point.frequency_hz, band);
            [libm::log(u), libm::log1p(-u), libm::log(point.magnitude.max(faintest))]
        };
        let rows = || inside(points, band).map(row);
        let count = rows().count() as f64;
        let sum = rows().fold([0.0; 3], |sum, row| core::array::from_fn(|i| sum[i] + row[i]));
        let mean = sum.map(|sum| sum / count);
        let zero = Self { xx: 0.0, xy: 0.0, yy: 0.0, xz: 0.0, yz: 0.0 };
        let all = rows().fold(zero, |all, row| {
            let [x, y, z] = core::array::from_fn(|i| row[i] - mean[i]);
            Self {
                xx: all.xx + x * x,
                xy: all.xy + x * y,
                yy: all.yy + y * y,
                xz: all.xz + x * z,
                yz: all.yz + y * z,
            }
        });
        let determined = all.xx * all.yy - all.xy * all.xy > SAME * all.xx * all.yy;
        (count >= 3.0 && determined && (all.xz + all.yz).is_finite()).then_some(all)
    }

    /// Returns the two factors between the bounds with the least squares. If the minimum is outside
    /// the bounds, returns the best point on the four sides of the allowed square.
    fn least(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let determinant = self.xx * self.yy - self.xy * self.xy;
        let free = [
            (self.yy * self.xz - self.xy * self.yz) / determinant,
            (self.xx * self.yz - self.xy * self.xz) / determinant,
        ];
        if free.iter().all(|factor| (low..=high).contains(factor)) {
            return free;
        }
        // The cost is convex. So if its minimum is outside the bounds, the best point within them
        // is on one of the sides.
        let sides = [low, high].into_iter().flat_map(|bound| {
            let beside_a = ((self.yz - self.xy * bound) / self.yy).clamp(low, high);
            let beside_b = ((self.xz - self.xy * bound) / self.xx).clamp(low, high);
            [[bound, beside_a], [beside_b, bound]]
        });
        let nearer = |a: &[f64; 2], b: &[f64; 2]| self.cost(*a).total_cmp(&self.cost(*b));
        sides.min_by(nearer).unwrap_or(free)
    }

    /// Returns the remaining sum of squares, up to a constant.
    fn cost(&self, [a, b]: [f64; 2]) -> f64 {
        a * a * self.xx + 2.0 * a * b * self.xy + b * b * self.yy
            - 2.0 * (a * self.xz + b * self.yz)
    }
}

/// Returns the points inside the band. Points at the edges of the band are excluded, because a
/// density may be 0 at an edge however well it fits elsewhere.
fn inside(points: &[Peak], band: Band) -> impl Iterator<Item = &Peak> {
    let Band { low_hz, high_hz } = band;
    let inside = move |p: &&Peak| low_hz < p.frequency_hz && p.frequency_hz < high_hz;
    points.iter().filter(inside)
}

/// Returns the best scale, and the mean squared difference of natural logarithms at this scale, for
/// the points inside the band.
pub(crate) fn least_decibels(points: &[Peak], profile: &Profile) -> (f64, f64) {
    let points = || inside(points, profile.band);
    let density = |point: &Peak| profile.density_at(point.frequency_hz);
    let least_density = FAINTEST * points().map(density).fold(0.0, f64::max);
    let least_magnitude = FAINTEST * points().map(|point| point.magnitude).fold(0.0, f64::max);
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for point in points() {
        let magnitude = point.magnitude.max(least_magnitude);
        let ratio = libm::log(magnitude) - libm::log(density(point).max(least_density));
        count += 1.0;
        sum += ratio;
        squares += ratio * ratio;
    }
    let mean = sum / count;
    (libm::exp(mean), squares / count - mean * mean)
}
