//! The magnitude that a recording of a voice reads, where it is not the model's own.

use htex_dsp::grid::{GRID_HZ, level_rms};
use htex_dsp::window::hann_main_lobe;

use crate::{Band, HostError, LoadedModel};

/// Points of a bin at which a magnitude is read.
const IN_BIN: i32 = 8;
/// Part of a bin that a voice plays beyond the edges of its band: half of the edge bin's.
const BESIDE_EDGE_BINS: f64 = 0.5;

impl LoadedModel {
    /// Whether the voice reads as its magnitude states. The magnitude of sinusoids is that through the window, and the voice of a model that
    /// keeps energies compensates the window's blur, each as far as the main lobe of the window goes. Other voices play their magnitude as a
    /// density.
    pub fn reads_as_stated(&self) -> bool {
        self.descriptor().is_sum_of_sines() || self.descriptor().keeps_level
    }

    /// Returns the magnitude on the band's grid, of unit RMS, that a recording of the voice reads through a Hann window of 0.2 s: bins next to
    /// steep flanks read the flank, and those at the band's edges read what is played half a bin beyond and nothing further. The model's
    /// own magnitude if the voice [reads as stated](Self::reads_as_stated).
    ///
    /// # Errors
    /// As [`Self::magnitude`].
    pub fn read_magnitude(&self, parameters: &[f64], band: Band) -> Result<Vec<f64>, HostError> {
        let grid = band.grid_hz();
        if self.reads_as_stated() {
            return self.magnitude(parameters, band, &grid);
        }
        // Positions in the window's main lobe, in bins, and their weights.
        let place = |i: i32| f64::from(i) / f64::from(IN_BIN);
        let lobe: Vec<(f64, f64)> = (-2 * IN_BIN..=2 * IN_BIN)
            .map(|i| (place(i), hann_main_lobe(place(i)).powi(2)))
            .collect();
        let played_at = |hz: f64| {
            let edge_hz = hz.clamp(band.low_hz, band.high_hz);
            match (hz - edge_hz).abs() <= BESIDE_EDGE_BINS * GRID_HZ {
                true => edge_hz,
                false => hz.max(0.0),
            }
        };
        let dense: Vec<f64> = grid
            .iter()
            .flat_map(|hz| lobe.iter().map(move |(d, _)| hz + d * GRID_HZ))
            .map(played_at)
            .collect();
        let magnitude = self.magnitude(parameters, band, &dense)?;
        let power = |part: &[f64]| -> f64 {
            let weighed = part
                .iter()
                .zip(&lobe)
                .map(|(m, (_, weight))| weight * m * m);
            weighed.sum()
        };
        let mut read: Vec<f64> = magnitude.chunks(lobe.len()).map(power).collect();
        read.iter_mut().for_each(|power| *power = power.sqrt());
        let rms = level_rms(&read);
        if rms > 0.0 {
            read.iter_mut().for_each(|m| *m /= rms);
        }
        Ok(read)
    }
}
