//! From band energies to a spectrum that has them.
//!
//! The logarithm of power is straight between *knots* at the bands' apexes, over the logarithm of
//! frequency, and level beyond the outermost. So the curve is monotone between two knots and never
//! passes either. Bins that no band weighs, at the edges, have the power of the next that one does. Of all spectra with the same energies, one of this form has the largest entropy; where
//! there is one, there is just one.
//!
//! The knots are found by Newton's method on the logarithms of the energies, whose derivative is
//! tridiagonal: only neighbouring bands overlap.

use htex_dsp::beta::log_unit;
use htex_dsp::grid::Band;

use crate::FLOOR_DB;

/// Newton's steps at most. Spectra of noise take four to ten; energies that no spectrum on the grid has
/// take all.
const STEPS: usize = 40;
/// Energies are met when the logarithm of each is this near.
const TOLERANCE: f64 = 1e-9;
/// Added to the derivative, relative to each energy: holds knots that share all their bins.
const DAMPING: f64 = 1e-3;
/// Logarithm of power that a bin may rise by in one step.
const RISE: f64 = 2.0;
/// Energies count as at least this, so that their logarithm is finite.
const TINY: f64 = 1e-300;

/// A bin of the grid: on the way from `knot` to the next, `share` of its logarithm from the first.
#[derive(Clone, Copy)]
struct Bin {
    knot: usize,
    share: f64,
    /// Sum of the triangles' weights: 1 but beyond the outermost apexes, 0 at the band's edges.
    weight: f64,
}

/// Knots, and what is needed to find them without allocating.
pub(crate) struct Knots {
    bins: Vec<Bin>,
    /// Sum of each band's weights; 0 for a band that no bin falls into, which has no say.
    sums: Vec<f64>,
    /// Logarithms of the energies wanted.
    wanted: Vec<f64>,
    /// Logarithms of power.
    knots: Vec<f64>,
    best: Vec<f64>,
    power: Vec<f64>,
    energy: Vec<f64>,
    diagonal: Vec<f64>,
    beside: Vec<f64>,
    step: Vec<f64>,
}

impl Knots {
    /// Knots of `bands` log-spaced triangular bands over a band.
    pub(crate) fn new(bands: usize, band: Band) -> Self {
        let grid = band.grid_hz();
        let mut bins: Vec<Bin> = grid.iter().map(|&f| Bin::new(f, bands, band)).collect();
        let mut sums = vec![0.0; bands];
        for bin in &bins {
            sums[bin.knot] += bin.weight * bin.share;
            sums[bin.next(bands)] += bin.weight * (1.0 - bin.share);
        }
        level_ends(&mut bins);
        let zeros = || vec![0.0; bands];
        Self {
            power: vec![0.0; bins.len()],
            bins,
            sums,
            wanted: zeros(),
            knots: zeros(),
            best: zeros(),
            energy: zeros(),
            diagonal: zeros(),
            beside: zeros(),
            step: zeros(),
        }
    }

    pub(crate) fn bands(&self) -> usize {
        self.sums.len()
    }

    /// Power on the band's grid; the loudest band's energy is 1.
    pub(crate) fn power(&self) -> &[f64] {
        &self.power
    }

    /// Finds the knots of energies given as decibels below any common value. Does not allocate.
    ///
    /// Where no spectrum has them, those of the nearest energies come out that were met with: by the
    /// mean square of decibels.
    pub(crate) fn solve(&mut self, below_db: impl Fn(usize) -> f64) {
        self.start(below_db);
        let mut least = f64::INFINITY;
        for _ in 0..STEPS {
            self.measure();
            let (square, largest) = self.residual();
            if square < least {
                least = square;
                self.best.copy_from_slice(&self.knots);
            }
            if largest < TOLERANCE || !self.advance() {
                break;
            }
        }
        self.knots.copy_from_slice(&self.best);
        self.measure();
    }

    /// Sets the energies wanted, and knots as if the power were even in each band.
    fn start(&mut self, below_db: impl Fn(usize) -> f64) {
        let held = |band: &usize| self.sums[*band] > 0.0;
        let bands = 0..self.sums.len();
        let loudest = bands.clone().filter(held).map(&below_db);
        let loudest = loudest.fold(f64::INFINITY, f64::min);
        for band in bands {
            if self.sums[band] > 0.0 {
                let below_db = (below_db(band) - loudest).min(FLOOR_DB);
                self.wanted[band] = -below_db * core::f64::consts::LN_10 / 10.0;
                self.knots[band] = self.wanted[band] - libm::log(self.sums[band]);
            }
        }
    }

    /// Powers and energies of the knots, and the energies' derivatives by the knots.
    fn measure(&mut self) {
        let bands = self.bands();
        for sum in [&mut self.energy, &mut self.diagonal, &mut self.beside] {
            sum.fill(0.0);
        }
        for (bin, power) in self.bins.iter().zip(&mut self.power) {
            let (here, next) = (bin.knot, bin.next(bands));
            *power = libm::exp(bin.between(&self.knots));
            let (a, b) = (bin.share, 1.0 - bin.share);
            let weighed = bin.weight * *power;
            self.energy[here] += weighed * a;
            self.energy[next] += weighed * b;
            self.diagonal[here] += weighed * a * a;
            self.diagonal[next] += weighed * b * b;
            self.beside[here] += weighed * a * b;
        }
    }

    /// What the logarithms of the energies lack, into `step`: the sum of squares, and the largest.
    fn residual(&mut self) -> (f64, f64) {
        let (mut square, mut largest) = (0.0, 0.0_f64);
        for band in 0..self.step.len() {
            let held = self.sums[band] > 0.0;
            let lack = if held {
                self.wanted[band] - libm::log(self.energy[band].max(TINY))
            } else {
                0.0
            };
            self.step[band] = lack;
            square += lack * lack;
            largest = largest.max(lack.abs());
        }
        (square, largest)
    }

    /// One step of Newton's method, shortened where power would rise fast; false if there is none.
    fn advance(&mut self) -> bool {
        for band in 0..self.step.len() {
            let energy = self.energy[band].max(TINY);
            self.step[band] *= energy;
            self.diagonal[band] += DAMPING * energy;
        }
        solve_tridiagonal(&mut self.diagonal, &self.beside, &mut self.step);
        let rise = self.bins.iter().map(|bin| bin.between(&self.step));
        let rise = rise.fold(0.0, f64::max);
        let part = (RISE / rise).min(1.0);
        for (knot, step) in self.knots.iter_mut().zip(&self.step) {
            *knot += part * step;
        }
        self.knots.iter().all(|knot| knot.is_finite())
    }
}

impl Bin {
    fn new(frequency_hz: f64, bands: usize, band: Band) -> Self {
        // On this axis apex `i` of the bands counted from 0 is at `i + 1`.
        let last = (bands + 1) as f64;
        let place = log_unit(frequency_hz, band) * last;
        let inside = place.clamp(1.0, bands as f64);
        let knot = (inside as usize).min(bands);
        Self {
            knot: knot - 1,
            share: 1.0 - (inside - knot as f64),
            weight: place.min(last - place).clamp(0.0, 1.0),
        }
    }

    /// The knot behind, or the last.
    fn next(&self, bands: usize) -> usize {
        (self.knot + 1).min(bands - 1)
    }

    /// The value here of what is straight between knots.
    fn between(&self, knots: &[f64]) -> f64 {
        let next = knots[self.next(knots.len())];
        self.share * knots[self.knot] + (1.0 - self.share) * next
    }
}

/// Gives the bins that no band weighs the power of their neighbours: no energy would hold it.
fn level_ends(bins: &mut [Bin]) {
    let weighed = |bin: &Bin| bin.weight > 0.0;
    let (Some(first), Some(last)) = (
        bins.iter().position(weighed),
        bins.iter().rposition(weighed),
    ) else {
        return;
    };
    let unweighed = |bin: Bin| Bin { weight: 0.0, ..bin };
    let (low, high) = (unweighed(bins[first]), unweighed(bins[last]));
    bins[..first].fill(low);
    bins[last + 1..].fill(high);
}

/// Solves a symmetric, positive definite, tridiagonal system in place; `beside[i]` couples `i` and
/// `i + 1`.
fn solve_tridiagonal(diagonal: &mut [f64], beside: &[f64], values: &mut [f64]) {
    for i in 1..values.len() {
        let ratio = beside[i - 1] / diagonal[i - 1];
        diagonal[i] -= ratio * beside[i - 1];
        values[i] -= ratio * values[i - 1];
    }
    for i in (0..values.len()).rev() {
        let behind = if i + 1 < values.len() {
            beside[i] * values[i + 1]
        } else {
            0.0
        };
        values[i] = (values[i] - behind) / diagonal[i];
    }
}
