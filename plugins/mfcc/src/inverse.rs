//! Converts band energies to a spectrum.

use alloc::vec::Vec;

use alloc::sync::Arc;

use htex_dsp::dct::InverseDct;
use htex_dsp::grid::Band;
use htex_dsp::least_squares::PseudoInverse;
use htex_dsp::mel::MelBank;
use htex_dsp::non_negative::{NonNegative, Scratch};
use htex_model::{Lock, Values};

use crate::{BANDS, INVERSE, whole};

/// Number of cached inverses. They are cached because computing an inverse takes longer than
/// creating a voice with it.
const KEPT: usize = 8;
const NNLS: u8 = 1;
const INTERPOLATE: u8 = 2;
const LOG_LOG: u8 = 3;
/// Beyond the outermost apexes, [`LOG_LOG`] continues the power as a power of the frequency. The
/// absolute value of the exponent is at most this value: 24 dB per octave. Without this limit, a
/// band of zero power next to the outermost band would raise the edge of the spectrum by hundreds
/// of decibels.
const STEEPEST: f64 = 8.0;

static CACHE: Lock<Vec<Arc<Inverse>>> = Lock::new(Vec::new());

/// Converts a cepstrum to magnitudes on the band's grid, for one mel bank and one kind of inverse.
pub(crate) struct Inverse {
    bands: usize,
    kind: u8,
    band: Band,
    cosines: InverseDct,
    way: Solver,
}

enum Solver {
    /// The power spectrum is computed by multiplying the band energies by this matrix and replacing
    /// negative results by 0. Each row of the matrix belongs to one band and has the power of this
    /// band in all bins.
    Matrix(Vec<f64>),
    NonNegative(NonNegative),
    LogLog(LogLog),
}

impl Inverse {
    /// Returns an inverse from the cache, or computes it.
    pub(crate) fn shared(bands: usize, kind: u8, band: Band) -> Arc<Self> {
        let Some(mut cache) = CACHE.lock() else {
            return Arc::new(Self::new(bands, kind, band));
        };
        let same = |i: &Arc<Self>| (i.bands, i.kind, i.band) == (bands, kind, band);
        if let Some(found) = cache.iter().position(same) {
            return Arc::clone(&cache[found]);
        }
        // The inverse is computed while the lock is held, so another voice that needs the same
        // inverse waits for it.
        let made = Arc::new(Self::new(bands, kind, band));
        if cache.len() == KEPT {
            cache.remove(0);
        }
        cache.push(Arc::clone(&made));
        made
    }

    fn new(bands: usize, kind: u8, band: Band) -> Self {
        let grid = band.grid_hz();
        let bank = MelBank::new(bands, band, &grid);
        let way = match kind {
            NNLS => Solver::NonNegative(NonNegative::new(bank.filters())),
            LOG_LOG => Solver::LogLog(LogLog::new(&bank, &grid)),
            _ => Solver::Matrix(Self::matrix(&bank, kind, bands, grid.len())),
        };
        Self { bands, kind, band, cosines: InverseDct::new(bands), way }
    }

    /// Returns a matrix with one row per band: the power in all bins for one unit of energy in the
    /// band.
    fn matrix(bank: &MelBank, kind: u8, bands: usize, bins: usize) -> Vec<f64> {
        let pseudo = (kind != INTERPOLATE)
            .then(|| PseudoInverse::new(&bank.filters().to_dense(), bands, bins));
        let mut matrix = vec![0.0; bins * bands];
        for (i, row) in matrix.chunks_mut(bins.max(1)).enumerate() {
            let mut unit = vec![0.0; bands];
            unit[i] = 1.0;
            match &pseudo {
                Some(inverse) => inverse.apply(&unit, row),
                None => bank.interpolate(&unit, row),
            }
        }
        matrix
    }

    pub(crate) fn bands(&self) -> usize {
        self.bands
    }

    /// Whether the parameters select this inverse.
    pub(crate) fn is(&self, parameters: &Values<'_>) -> bool {
        whole(parameters, BANDS) == self.bands && whole(parameters, INVERSE) as u8 == self.kind
    }

    /// Writes the power in each bin for a cepstrum. `energy` is working memory with one element per
    /// band. Does not allocate.
    pub(crate) fn power(
        &self,
        cepstrum: &[f64],
        energy: &mut [f64],
        scratch: &mut Scratch,
        power: &mut [f64],
    ) {
        self.cosines.run(cepstrum, energy);
        match &self.way {
            Solver::LogLog(lines) => lines.write_power(energy, power),
            Solver::NonNegative(solver) => solver.solve(exponentials(energy), power, scratch),
            Solver::Matrix(matrix) => {
                power.fill(0.0);
                let rows = matrix.chunks(power.len().max(1));
                for (row, energy) in rows.zip(exponentials(energy)) {
                    for (power, part) in power.iter_mut().zip(row) {
                        *power += part * *energy;
                    }
                }
                power.iter_mut().for_each(|power| *power = power.max(0.0));
            }
        }
    }
}

/// Replaces logarithms by the numbers.
fn exponentials(logarithms: &mut [f64]) -> &mut [f64] {
    logarithms.iter_mut().for_each(|e| *e = libm::exp(*e));
    logarithms
}

/// Straight lines between the apexes of the filters, on a plot of the logarithm of power over the
/// logarithm of frequency. Beyond the outermost apexes, the lines continue. The other inverses give
/// the edges of the band no power, or the power at the outermost apex, so they lose what a spectrum
/// has at an edge.
struct LogLog {
    /// Logarithm of the sum of each filter's weights; 0 for an empty filter.
    log_sums: Vec<f64>,
    places: Vec<Place>,
}

/// The place of a bin on a line.
#[derive(Default)]
struct Place {
    /// The filters at the ends of the line. They differ, except if only one filter has weights.
    ends: [usize; 2],
    /// Distance from the first end, relative to the length of the line. Negative before the first
    /// end.
    along: f64,
    /// Largest absolute value of the difference between the ends.
    steepest: f64,
}

impl LogLog {
    fn new(bank: &MelBank, grid_hz: &[f64]) -> Self {
        let sums = bank.filters().row_sums();
        let apexes: Vec<(usize, f64)> = (0..sums.len())
            .filter(|&row| sums[row] > 0.0)
            .map(|row| (row, libm::log(bank.edges_hz()[row + 1])))
            .collect();
        Self {
            log_sums: sums.iter().map(|&s| if s > 0.0 { libm::log(s) } else { 0.0 }).collect(),
            places: match apexes.first() {
                // Without weights there is no power.
                None => Vec::new(),
                Some(_) => grid_hz.iter().map(|&f| Place::new(&apexes, libm::log(f))).collect(),
            },
        }
    }

    /// Writes the power for the logarithms of the bands' energies.
    fn write_power(&self, log_energy: &mut [f64], power: &mut [f64]) {
        log_energy.iter_mut().zip(&self.log_sums).for_each(|(level, sum)| *level -= sum);
        power.fill(0.0);
        for (power, place) in power.iter_mut().zip(&self.places) {
            let [from, to] = place.ends.map(|end| log_energy[end]);
            let rise = (to - from).clamp(-place.steepest, place.steepest);
            *power = libm::exp(from + place.along * rise);
        }
    }
}

impl Place {
    /// Finds the place of a bin. `apexes` are the filters with weights, at least one, and the
    /// logarithms of their apexes, ascending.
    fn new(apexes: &[(usize, f64)], at: f64) -> Self {
        let last = apexes.len() - 1;
        let above = apexes.partition_point(|apex| apex.1 <= at).clamp(1, last.max(1)).min(last);
        let pair = [apexes[above.saturating_sub(1)], apexes[above]];
        // Beyond the last apex, the line begins at this apex, so that the limit does not change the
        // power at the apex.
        let [from, to] = if at > pair[1].1 { [pair[1], pair[0]] } else { pair };
        let length = to.1 - from.1;
        if length == 0.0 {
            return Self { ends: [from.0; 2], ..Self::default() };
        }
        let along = (at - from.1) / length;
        let steepest = if along < 0.0 { STEEPEST * length.abs() } else { f64::MAX };
        Self { ends: [from.0, to.0], along, steepest }
    }
}
