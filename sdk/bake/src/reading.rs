//! Distance of the spectra of baked conditions from the model's.

use htex_dsp::bands::{BAND_COUNT, BandBank, band_error_db};
use htex_host::Band;

/// Bands this far below the strongest, as energies, are not compared: 40 dB.
const FAINT: f64 = 1e-4;

/// The nine bands of a band's grid.
pub(crate) struct Bands(BandBank);

impl Bands {
    pub(crate) fn new(band: Band) -> Self {
        Self(BandBank::new(BAND_COUNT, band, &band.grid_hz()))
    }

    /// Returns the largest error of the nine bands, dB, among those within 40 dB of the strongest.
    pub(crate) fn distance_db(&self, reference: &[f64], read: &[f64]) -> f64 {
        let [reference, read] = [reference, read].map(|magnitude| self.0.energies(magnitude));
        let strongest = reference.iter().copied().fold(0.0, f64::max);
        let errors = band_error_db(&reference, &read).into_iter().zip(&reference);
        let compared = errors.filter(|(_, energy)| **energy >= FAINT * strongest);
        compared.map(|(error, _)| error.abs()).fold(0.0, f64::max)
    }
}
