//! Distances of a density in decibels, and the density that is nearest to points, in closed form.
//!
//! `ln(density) = (α - 1) ln u + (β - 1) ln(1 - u) + scale` is linear in its three unknowns: least
//! squares with two bounded unknowns. Where a density is so faint at a point that its decibels are
//! cut off, the distance is another one, and a search takes over.

use htex_dsp::beta::log_unit;
use htex_dsp::grid::Band;
use htex_dsp::peaks::Peak;

use crate::Profile;

/// Lower limit, relative to the largest, of points and densities compared in decibels.
const FAINTEST: f64 = 1e-6;
/// Part of the squares below which the two axes are the same.
const SAME: f64 = 1e-9;

/// Returns alpha and beta between the bounds with the least squared difference of decibels; `None`
/// where the points do not determine them, or the difference of some point is cut off.
pub(crate) fn nearest(points: &[Peak], band: Band, [low, high]: [f64; 2]) -> Option<(f64, f64)> {
    let squares = Squares::of(points, band)?;
    let [low, high] = [low - 1.0, high - 1.0];
    let [a, b] = squares.least([low, high]);
    let found = (a + 1.0, b + 1.0);
    let profile = Profile::new(found.0, found.1, band);
    let densities = || inside(points, band).map(|point| profile.at(point.frequency_hz));
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
    /// `None` if there are fewer points than unknowns, or they are in too few places.
    fn of(points: &[Peak], band: Band) -> Option<Self> {
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

    /// Returns the two factors, each between the bounds, with the least squares: the least of all
    /// if it is between them, else the best of the four sides.
    fn least(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let determinant = self.xx * self.yy - self.xy * self.xy;
        let free = [
            (self.yy * self.xz - self.xy * self.yz) / determinant,
            (self.xx * self.yz - self.xy * self.xz) / determinant,
        ];
        if free.iter().all(|factor| (low..=high).contains(factor)) {
            return free;
        }
        let sides = [low, high].into_iter().flat_map(|bound| {
            let beside_a = ((self.yz - self.xy * bound) / self.yy).clamp(low, high);
            let beside_b = ((self.xz - self.xy * bound) / self.xx).clamp(low, high);
            [[bound, beside_a], [beside_b, bound]]
        });
        let nearer = |a: &[f64; 2], b: &[f64; 2]| self.cost(*a).total_cmp(&self.cost(*b));
        sides.min_by(nearer).unwrap_or(free)
    }

    /// The sum of squares that is left, but for a constant.
    fn cost(&self, [a, b]: [f64; 2]) -> f64 {
        a * a * self.xx + 2.0 * a * b * self.xy + b * b * self.yy
            - 2.0 * (a * self.xz + b * self.yz)
    }
}

/// The points within the band; at its edges a density may be 0 however well it fits elsewhere.
fn inside(points: &[Peak], band: Band) -> impl Iterator<Item = &Peak> {
    let Band { low_hz, high_hz } = band;
    let inside = move |p: &&Peak| low_hz < p.frequency_hz && p.frequency_hz < high_hz;
    points.iter().filter(inside)
}

/// By the mean squared difference of natural logarithms, of the points within the band.
pub(crate) fn least_decibels(points: &[Peak], profile: &Profile) -> (f64, f64) {
    let points = || inside(points, profile.band);
    let density = |point: &Peak| profile.at(point.frequency_hz);
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
