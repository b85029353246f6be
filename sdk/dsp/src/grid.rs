//! The frequency grid every texture spectrum stands on.

use alloc::vec::Vec;

/// Spacing of the texture spectrum's grid: 4000 samples at 20 kHz (paper, Texture processing).
pub const GRID_HZ: f64 = 5.0;

/// The band a texture spectrum covers, inclusive at both ends, in hertz.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower edge, hertz.
    pub low_hz: f64,
    /// Upper edge, hertz.
    pub high_hz: f64,
}

impl Band {
    /// The tactile band of the paper: 20 to 1000 Hz.
    pub const TACTILE: Self = Self {
        low_hz: 20.0,
        high_hz: 1000.0,
    };

    /// Grid index (multiples of [`GRID_HZ`]) of the lowest bin in the band.
    pub fn first_bin(&self) -> usize {
        libm::ceil(self.low_hz / GRID_HZ - 1e-9) as usize
    }

    /// Grid index of the highest bin in the band.
    pub fn last_bin(&self) -> usize {
        libm::floor(self.high_hz / GRID_HZ + 1e-9) as usize
    }

    /// Number of grid bins in the band: 197 for 20 to 1000 Hz.
    pub fn bins(&self) -> usize {
        (self.last_bin() + 1).saturating_sub(self.first_bin())
    }

    /// The grid frequencies in the band, ascending, hertz.
    pub fn grid_hz(&self) -> Vec<f64> {
        (self.first_bin()..=self.last_bin())
            .map(|bin| bin as f64 * GRID_HZ)
            .collect()
    }

    /// Whether `frequency_hz` lies in the band, edges included.
    pub fn contains(&self, frequency_hz: f64) -> bool {
        (self.low_hz..=self.high_hz).contains(&frequency_hz)
    }
}

impl From<(f64, f64)> for Band {
    fn from((low_hz, high_hz): (f64, f64)) -> Self {
        Self { low_hz, high_hz }
    }
}

/// RMS of a texture spectrum given on the grid: each bin is read through the periodic Hann window,
/// so its power is `magnitude² / (2 · 1.5)` (equivalent noise bandwidth 1.5 bins).
///
/// Unit: that of the magnitudes.
pub fn level_rms(magnitude: &[f64]) -> f64 {
    libm::sqrt(magnitude.iter().map(|m| m * m).sum::<f64>() / 3.0)
}

/// [`level_rms`] of a curve read on the band's grid, without storing it.
pub fn curve_level_rms(band: Band, curve: impl Fn(f64) -> f64) -> f64 {
    let power: f64 = (band.first_bin()..=band.last_bin())
        .map(|bin| curve(bin as f64 * GRID_HZ))
        .map(|m| m * m)
        .sum();
    libm::sqrt(power / 3.0)
}
