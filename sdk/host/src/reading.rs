//! The magnitude that a recording of a voice reads, where it is not the model's own.

use htex_dsp::grid::{GRID_HZ, level_rms};
use htex_dsp::sharpening::sharpen;
use htex_dsp::window::hann_main_lobe;

use crate::{Band, HostError, LoadedModel};

/// Points of a bin at which a magnitude is read.
const IN_BIN: i32 = 8;
/// Part of a bin that a voice plays beyond the edges of its band: half of the edge bin's.
const BESIDE_EDGE_BINS: f64 = 0.5;

impl LoadedModel {
    /// Returns whether magnitudes are what a window reads of lines, and no density: those of sinusoids, and of models that follow the motion, whose
    /// surface a finger crosses again.
    pub fn has_lines(&self) -> bool {
        self.descriptor().is_sum_of_sines() || self.follows_motion()
    }

    /// Returns the magnitude on the band's grid, of unit RMS, that a recording of the voice reads through a Hann window of 0.2 s: bins next to
    /// steep flanks read the flank, and those at the band's edges read what is played half a bin beyond and nothing further.
    ///
    /// A voice plays its model's magnitude as a density; that of a model that keeps energies
    /// ([`keeps_level`](htex_model::Descriptor::keeps_level)) plays it [sharpened](sharpen). The magnitude of sinusoids is already what is
    /// read, as far as the window's main lobe goes.
    ///
    /// # Errors
    /// As [`Self::magnitude`].
    pub fn read_magnitude(&self, parameters: &[f64], band: Band) -> Result<Vec<f64>, HostError> {
        let grid = band.grid_hz();
        if self.has_lines() || grid.is_empty() {
            return self.magnitude(parameters, band, &grid);
        }
        // Positions in the window's main lobe, in bins, and their weights.
        let place = |i: i32| f64::from(i) / f64::from(IN_BIN);
        let lobe: Vec<(f64, f64)> = (-2 * IN_BIN..=2 * IN_BIN)
            .map(|i| (place(i), hann_main_lobe(place(i)).powi(2)))
            .collect();
        let dense: Vec<f64> = grid
            .iter()
            .flat_map(|hz| lobe.iter().map(move |(d, _)| hz + d * GRID_HZ))
            .map(|hz| played_at(band, hz))
            .collect();
        let density = match self.descriptor().keeps_level {
            true => sharpened(&self.magnitude(parameters, band, &grid)?, band, &dense),
            false => self.magnitude(parameters, band, &dense)?,
        };
        let power = |part: &[f64]| -> f64 {
            let weighed = part
                .iter()
                .zip(&lobe)
                .map(|(m, (_, weight))| weight * m * m);
            weighed.sum()
        };
        let mut read: Vec<f64> = density.chunks(lobe.len()).map(power).collect();
        read.iter_mut().for_each(|power| *power = power.sqrt());
        let rms = level_rms(&read);
        if rms > 0.0 {
            read.iter_mut().for_each(|m| *m /= rms);
        }
        Ok(read)
    }
}

/// Returns the frequency in the band that is played at a frequency: beyond an edge, that of the edge for half a bin.
fn played_at(band: Band, hz: f64) -> f64 {
    let edge_hz = hz.clamp(band.low_hz, band.high_hz);
    match (hz - edge_hz).abs() <= BESIDE_EDGE_BINS * GRID_HZ {
        true => edge_hz,
        false => hz.max(0.0),
    }
}

/// Returns the density of a sharpened magnitude, given on the band's grid, at frequencies in hertz: linear between bins, 0 outside the band.
fn sharpened(magnitude: &[f64], band: Band, hertz: &[f64]) -> Vec<f64> {
    let power: Vec<f64> = magnitude.iter().map(|m| m * m).collect();
    let (mut before, mut sharp) = (power.clone(), power.clone());
    sharpen(&power, &mut before, &mut sharp);
    let last = sharp.len().saturating_sub(1);
    let at = |hz: &f64| {
        if !band.contains(*hz) {
            return 0.0;
        }
        let place = (hz / GRID_HZ - band.first_bin() as f64).clamp(0.0, last as f64);
        let below = place as usize;
        let (a, b) = (sharp[below].sqrt(), sharp[(below + 1).min(last)].sqrt());
        a + place.fract() * (b - a)
    };
    hertz.iter().map(at).collect()
}
