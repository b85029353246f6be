//! The mel filter bank (paper, Mel-frequency cepstral coefficients) with HTK's mel formula.

use alloc::vec::Vec;

use crate::grid::Band;
use crate::triangles::TriangleBank;

/// Hertz to mel: `2595 log10(1 + f / 700)` (HTK book, eq. 5.13).
pub fn hz_to_mel(f_hz: f64) -> f64 {
    2595.0 * libm::log10(1.0 + f_hz / 700.0)
}

pub fn mel_to_hz(mel: f64) -> f64 {
    700.0 * (libm::pow(10.0, mel / 2595.0) - 1.0)
}

/// A bank of triangular filters with apex 1, linear in hertz, between edges that are equally spaced
/// in mel. Matches `librosa.filters.mel(htk=True, norm=None)`.
///
/// ```
/// use htex_dsp::{Band, mel::MelBank};
/// let grid_hz = Band::TACTILE.grid_hz();
/// let bank = MelBank::new(10, Band::TACTILE, &grid_hz);
/// assert_eq!(bank.energies(&[1.0; 197]).len(), 10);
/// assert!((bank.edges_hz()[0] - 20.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MelBank {
    edges_hz: Vec<f64>,
    frequencies_hz: Vec<f64>,
    bank: TriangleBank,
}

impl MelBank {
    /// Makes `bands` filters over `band`, with weights at `frequencies_hz` (ascending).
    ///
    /// Filters narrower than the grid spacing may be empty: their energy is always 0.
    pub fn new(bands: usize, band: Band, frequencies_hz: &[f64]) -> Self {
        let edges_hz = mel_edges(bands, band);
        Self {
            bank: TriangleBank::new(&edges_hz, frequencies_hz),
            edges_hz,
            frequencies_hz: frequencies_hz.to_vec(),
        }
    }

    /// The `bands + 2` edges, hertz. Filter `i` has its apex at edge `i + 1`.
    pub fn edges_hz(&self) -> &[f64] {
        &self.edges_hz
    }

    /// The weights.
    pub fn filters(&self) -> &TriangleBank {
        &self.bank
    }

    /// Returns the energy of a power spectrum in each band, in the unit of the power. `power`
    /// contains the values of the spectrum at the bank's frequencies.
    pub fn energies(&self, power: &[f64]) -> Vec<f64> {
        let mut energies = alloc::vec![0.0; self.bank.rows()];
        self.bank.apply(power, &mut energies);
        energies
    }

    /// Interpolates a power spectrum from band energies.
    ///
    /// At the apex of each filter, the power is the filter's energy divided by the sum of its
    /// weights. Between the apexes the power is linear in hertz; below the first and above the last
    /// apex it is constant. Empty filters are skipped. `power` has as many elements as the bank has
    /// frequencies.
    ///
    /// The result is never negative, and is smoother than a spectrum that is computed with the
    /// pseudo-inverse of the weights. But the band energies of the result ([`Self::energies`])
    /// differ slightly from the original energies.
    pub fn interpolate(&self, energies: &[f64], power: &mut [f64]) {
        let apexes: Vec<(f64, f64)> = self
            .bank
            .row_sums()
            .iter()
            .zip(&self.edges_hz[1..])
            .zip(energies)
            .filter(|((sum, _), _)| **sum > 0.0)
            .map(|((sum, apex_hz), energy)| (*apex_hz, energy / sum))
            .collect();
        for (power, &f_hz) in power.iter_mut().zip(&self.frequencies_hz) {
            *power = interpolate_linearly(&apexes, f_hz);
        }
    }
}

fn mel_edges(bands: usize, band: Band) -> Vec<f64> {
    let last = bands + 1;
    let (low, high) = (hz_to_mel(band.low_hz), hz_to_mel(band.high_hz));
    (0..=last)
        .map(|i| match i {
            // The ends are exact. Rounding would give a bin on an edge of the band a tiny weight
            // instead of none.
            0 => band.low_hz,
            i if i == last => band.high_hz,
            i => mel_to_hz(low + (high - low) * i as f64 / last as f64),
        })
        .collect()
}

/// Returns the value at `x` of the polyline through `points` (ascending). The value is constant
/// beyond the ends, and 0 if there are no points.
fn interpolate_linearly(points: &[(f64, f64)], x: f64) -> f64 {
    let above = points.partition_point(|point| point.0 <= x);
    match (above.checked_sub(1).and_then(|i| points.get(i)), points.get(above)) {
        (Some(left), Some(right)) => {
            let t = (x - left.0) / (right.0 - left.0);
            left.1 * (1.0 - t) + right.1 * t
        }
        (Some(end), None) | (None, Some(end)) => end.1,
        (None, None) => 0.0,
    }
}
