//! Fits the parameters of a spectrum's shape to band levels in decibels.
//!
//! The levels are the energies in 30 triangular bands, which cover the frequency band on the axis
//! [`edge_to_edge`]. The model Bands uses the same bands by default. Fits to third octaves would
//! have a smaller third-octave error. But the project compares all models by this error. To keep
//! this comparison fair, no model is fitted to third octaves. Only the shape counts, because the
//! energies of the spectrum and of the model are each divided by their sum.
//!
//! The search is the Levenberg–Marquardt method. The derivatives are computed as finite
//! differences, so a model has to provide only its power spectrum.

use alloc::vec::Vec;

use crate::bands::edge_to_edge;
use crate::grid::Band;
use crate::triangles::TriangleBank;

/// Number of bands.
const BANDS: usize = 30;
/// Fraction of the total energy that is added to the energy of each band. It limits the level of an
/// empty band to -120 dB.
const FLOOR: f64 = 1e-12;
/// Maximum number of steps; recordings need four to twenty.
const STEPS: usize = 50;
/// The search ends when a step reduces the cost by less than this fraction.
const TOLERANCE: f64 = 1e-7;
/// Initial damping, and largest damping. At the largest damping the search ends, because no step
/// reduces the cost any more.
const DAMPING: (f64, f64) = (1e-3, 1e8);
/// Maximum change of a parameter in one step.
const STRIDE: f64 = 1.0;
/// Change of a parameter with which its derivative is computed: relative to the parameter, or
/// absolute if the parameter is below 1.
const DIFFERENCE: f64 = 1e-6;

/// The band levels to which a model is fitted, measured from a spectrum.
///
/// ```
/// use htex_dsp::{Band, decibel_fit::DecibelFit};
/// // A spectrum whose power falls with the square of the frequency.
/// let grid_hz = Band::TACTILE.grid_hz();
/// let power: Vec<f64> = grid_hz.iter().map(|f| 1.0 / (f * f)).collect();
/// let mut exponent = [0.0];
/// DecibelFit::new(Band::TACTILE, &grid_hz, &power).run(&mut exponent, |exponent, power| {
///     for (power, f) in power.iter_mut().zip(&grid_hz) {
///         *power = f.powf(exponent[0]);
///     }
/// });
/// assert!((exponent[0] + 2.0).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DecibelFit {
    bank: TriangleBank,
    /// The bands that contain bins.
    rows: Vec<usize>,
    /// Logarithms of the energies relative to their sum, one for each of `rows`.
    wanted: Vec<f64>,
}

/// Parameters, and the differences of their levels from the wanted levels.
struct Trial {
    parameters: Vec<f64>,
    differences: Vec<f64>,
    cost: f64,
}

impl DecibelFit {
    /// Measures the band levels of a power spectrum that is given at the frequencies `frequency_hz`
    /// (ascending, in the band).
    pub fn new(band: Band, frequency_hz: &[f64], power: &[f64]) -> Self {
        let edges: Vec<f64> = (0..BANDS + 2).map(|i| i as f64 - 1.0).collect();
        let place = |&f: &f64| edge_to_edge(f, band) * (BANDS - 1) as f64;
        let bank = TriangleBank::new(&edges, &frequency_hz.iter().map(place).collect::<Vec<_>>());
        let sums = bank.row_sums();
        let rows = (0..BANDS).filter(|&row| sums[row] > 0.0).collect();
        let mut levels = Self { bank, rows, wanted: Vec::new() };
        levels.wanted = levels.levels(power);
        levels
    }

    /// Moves the parameters to the nearest minimum of the sum of squared differences. `shape`
    /// writes the power spectrum for a set of parameters, in any scale. The parameters keep their
    /// start values if the spectrum at the start has no power, or if its power is not finite.
    pub fn run(&self, parameters: &mut [f64], mut shape: impl FnMut(&[f64], &mut [f64])) {
        let mut power = alloc::vec![0.0; self.bank.columns()];
        let mut best = self.trial(parameters.to_vec(), &mut power, &mut shape);
        let mut damping = DAMPING.0;
        for _ in 0..STEPS {
            let before = best.cost;
            let by = self.derivatives(&best, &mut power, &mut shape);
            while damping <= DAMPING.1 {
                let next = step(&best, &by, damping);
                let trial = self.trial(next, &mut power, &mut shape);
                // This is false if the cost of the trial is NaN.
                if trial.cost < best.cost {
                    best = trial;
                    damping *= 0.25;
                    break;
                }
                damping *= 8.0;
            }
            let gain = before - best.cost;
            if gain.is_nan() || gain <= TOLERANCE * before {
                break;
            }
        }
        parameters.copy_from_slice(&best.parameters);
    }

    /// Returns the logarithms of the bands' energies relative to their sum.
    fn levels(&self, power: &[f64]) -> Vec<f64> {
        let mut energies = alloc::vec![0.0; BANDS];
        self.bank.apply(power, &mut energies);
        let sum: f64 = energies.iter().sum();
        self.rows.iter().map(|&row| libm::log(energies[row] / sum + FLOOR)).collect()
    }

    fn trial(
        &self,
        parameters: Vec<f64>,
        power: &mut [f64],
        shape: &mut impl FnMut(&[f64], &mut [f64]),
    ) -> Trial {
        shape(&parameters, power);
        let mut differences = self.levels(power);
        for (difference, wanted) in differences.iter_mut().zip(&self.wanted) {
            *difference -= wanted;
        }
        let cost = differences.iter().map(|d| d * d).sum();
        Trial { parameters, differences, cost }
    }

    /// Returns the derivatives of all differences with respect to each parameter.
    fn derivatives(
        &self,
        at: &Trial,
        power: &mut [f64],
        shape: &mut impl FnMut(&[f64], &mut [f64]),
    ) -> Vec<Vec<f64>> {
        let by = |i: usize| {
            let mut moved = at.parameters.clone();
            moved[i] += DIFFERENCE * moved[i].abs().max(1.0);
            // The difference as rounded.
            let by = moved[i] - at.parameters[i];
            let mut row = self.trial(moved, power, shape).differences;
            row.iter_mut().zip(&at.differences).for_each(|(d, here)| *d = (*d - here) / by);
            row
        };
        (0..at.parameters.len()).map(by).collect()
    }
}

/// Returns the parameters after a damped step: minus `Jᵀ (J Jᵀ + damping)⁻¹ d`, where the rows of
/// `Jᵀ` are `by`. This equals the usual `(Jᵀ J + damping)⁻¹ Jᵀ d`, but the size of the system is
/// the number of bands, and a model may have far more parameters than bands.
fn step(from: &Trial, by: &[Vec<f64>], damping: f64) -> Vec<f64> {
    let size = from.differences.len();
    let mut matrix = alloc::vec![0.0; size * size];
    for derivatives in by {
        for (row, a) in matrix.chunks_mut(size.max(1)).zip(derivatives) {
            row.iter_mut().zip(derivatives).for_each(|(sum, b)| *sum += a * b);
        }
    }
    matrix.iter_mut().step_by(size + 1).for_each(|diagonal| *diagonal += damping);
    let mut solution = from.differences.clone();
    solve_positive_definite(&mut matrix, &mut solution);
    let product = |row: &Vec<f64>| row.iter().zip(&solution).map(|(d, s)| d * s).sum();
    let step: Vec<f64> = by.iter().map(product).collect();
    let largest = step.iter().fold(0.0_f64, |largest, s| largest.max(s.abs()));
    let part = (STRIDE / largest).min(1.0);
    from.parameters.iter().zip(&step).map(|(x, s)| x - part * s).collect()
}

/// Solves a symmetric positive definite system in place, by an L D Lᵀ decomposition.
fn solve_positive_definite(matrix: &mut [f64], values: &mut [f64]) {
    let size = values.len();
    for i in 0..size {
        for j in i + 1..size {
            let ratio = matrix[j * size + i] / matrix[i * size + i];
            for k in j..size {
                matrix[k * size + j] -= ratio * matrix[k * size + i];
            }
            values[j] -= ratio * values[i];
        }
    }
    for i in (0..size).rev() {
        let behind: f64 = (i + 1..size).map(|j| matrix[j * size + i] * values[j]).sum();
        values[i] = (values[i] - behind) / matrix[i * size + i];
    }
}
