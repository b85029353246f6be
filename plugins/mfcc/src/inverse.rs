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

    /// Writes the magnitudes for a cepstrum. `energy` is working memory with one element per band.
    /// Does not allocate.
    pub(crate) fn magnitude(
        &self,
        cepstrum: &[f64],
        energy: &mut [f64],
        scratch: &mut Scratch,
        magnitude: &mut [f64],
    ) {
        self.cosines.run(cepstrum, energy);
        energy.iter_mut().for_each(|e| *e = libm::exp(*e));
        match &self.way {
            Solver::Matrix(matrix) => {
                magnitude.fill(0.0);
                let rows = matrix.chunks(magnitude.len().max(1));
                for (row, energy) in rows.zip(&*energy) {
                    for (power, part) in magnitude.iter_mut().zip(row) {
                        *power += part * energy;
                    }
                }
                magnitude.iter_mut().for_each(|power| *power = power.max(0.0));
            }
            Solver::NonNegative(solver) => solver.solve(energy, magnitude, scratch),
        }
        magnitude.iter_mut().for_each(|m| *m = htex_dsp::root::sqrt(*m));
    }
}
