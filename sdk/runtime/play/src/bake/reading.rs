//! Compares the spectra of a baked block with the spectra of the model.

use htex_dsp::bands::{BAND_COUNT, BandBank, band_error_db};
use htex_host::Band;

/// Bands with less than this part of the strongest band's energy (40 dB below it) are not compared.
const FAINT: f64 = 1e-4;

/// The nine bands in which spectra are compared.
pub(crate) struct Bands(BandBank);

impl Bands {
    pub(crate) fn new(band: Band) -> Self {
        Self(BandBank::new(BAND_COUNT, band, &band.grid_hz()))
    }

    /// Returns the largest error of the nine bands, dB. Only bands within 40 dB of the strongest
    /// band count.
    pub(crate) fn distance_db(&self, reference: &[f64], read: &[f64]) -> f64 {
        let [reference, read] = [reference, read].map(|magnitude| self.0.energies(magnitude));
        let strongest = reference.iter().copied().fold(0.0, f64::max);
        let errors = band_error_db(&reference, &read).into_iter().zip(&reference);
        let compared = errors.filter(|(_, energy)| **energy >= FAINT * strongest);
        compared.map(|(error, _)| error.abs()).fold(0.0, f64::max)
    }
}
