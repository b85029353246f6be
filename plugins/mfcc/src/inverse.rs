//! The way back from band energies to a spectrum.

use std::sync::{Arc, Mutex, PoisonError};

use htex_dsp::dct::inverse_dct_ii;
use htex_dsp::grid::Band;
use htex_dsp::least_squares::{NonNegative, PseudoInverse};
use htex_dsp::mel::MelBank;
use htex_model::Values;

use crate::{BANDS, INVERSE};

/// Inverses kept for the next voice: making one takes longer than making a voice of it.
const KEPT: usize = 8;
const NNLS: u8 = 1;
const INTERPOLATE: u8 = 2;
const NNLS_SWEEPS: usize = 200;
const NNLS_TOLERANCE: f64 = 1e-9;

static CACHE: Mutex<Vec<Arc<Inverse>>> = Mutex::new(Vec::new());

/// From cepstrum to magnitudes on the band's grid, for one mel bank and one kind of inverse.
pub(crate) struct Inverse {
    bands: usize,
    kind: u8,
    band: Band,
    /// Power = `matrix` · energies, a row a bin.
    matrix: Vec<f64>,
    /// The bank itself, where the power is refined.
    refine: Option<NonNegative>,
}

impl Inverse {
    /// Makes an inverse, or finds one made before.
    pub(crate) fn shared(bands: usize, kind: u8, band: Band) -> Arc<Self> {
        let mut cache = CACHE.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |i: &Arc<Self>| (i.bands, i.kind, i.band) == (bands, kind, band);
        if let Some(found) = cache.iter().position(same) {
            return Arc::clone(&cache[found]);
        }
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
        let dense = bank.filters().to_dense();
        let pseudo = (kind != INTERPOLATE).then(|| PseudoInverse::new(&dense, bands, grid.len()));
        let mut matrix = vec![0.0; grid.len() * bands];
        let mut column = vec![0.0; grid.len()];
        for i in 0..bands {
            let mut unit = vec![0.0; bands];
            unit[i] = 1.0;
            match &pseudo {
                Some(inverse) => inverse.apply(&unit, &mut column),
                None => bank.interpolate(&unit, &mut column),
            }
            for (row, value) in matrix.chunks_mut(bands).zip(&column) {
                row[i] = *value;
            }
        }
        Self {
            bands,
            kind,
            band,
            matrix,
            refine: (kind == NNLS).then(|| NonNegative::new(&dense, grid.len())),
        }
    }

    pub(crate) fn bands(&self) -> usize {
        self.bands
    }

    /// Whether parameters ask for this inverse.
    pub(crate) fn is(&self, parameters: &Values<'_>) -> bool {
        parameters.scalar(BANDS) as usize == self.bands
            && parameters.scalar(INVERSE) as u8 == self.kind
    }

    /// Magnitudes of a cepstrum; `energy` has room for the bands. Does not allocate.
    pub(crate) fn magnitude(&self, cepstrum: &[f64], energy: &mut [f64], magnitude: &mut [f64]) {
        inverse_dct_ii(cepstrum, energy);
        energy.iter_mut().for_each(|e| *e = libm::exp(*e));
        for (power, row) in magnitude.iter_mut().zip(self.matrix.chunks(self.bands)) {
            let sum: f64 = row.iter().zip(&*energy).map(|(w, e)| w * e).sum();
            *power = sum.max(0.0);
        }
        if let Some(refine) = &self.refine {
            refine.improve(magnitude, energy, NNLS_SWEEPS, NNLS_TOLERANCE);
        }
        magnitude.iter_mut().for_each(|m| *m = libm::sqrt(*m));
    }
}
