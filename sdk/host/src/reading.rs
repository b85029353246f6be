//! The magnitude that a recording of a voice reads, where it is not the model's own.

use htex_dsp::grid::{GRID_HZ, level_rms};
use htex_dsp::resample::OwnRate;
use htex_dsp::sharpening::sharpen;
use htex_dsp::window::hann_main_lobe;

use crate::model::HIGH_RATE_HZ;
use crate::{Band, HostError, LoadedModel};

/// Points of a bin at which a magnitude is read.
const IN_BIN: i32 = 8;
/// Part of a bin that a voice plays beyond the edges of its band: half of the edge bin's.
const BESIDE_EDGE_BINS: f64 = 0.5;
/// Part of a source's own rate up to which its content passes whole.
const BELOW_OWN_RATE: f64 = 0.49;

impl LoadedModel {
    /// Returns whether magnitudes are what a window reads of lines, and no density: those of
    /// sinusoids, and of models that follow the motion, whose surface a finger crosses again.
    pub fn has_lines(&self) -> bool {
        self.descriptor().is_sum_of_sines() || self.follows_motion()
    }

    /// Returns the magnitude on the band's grid, of unit RMS, that a recording of the voice reads
    /// through a Hann window of 0.2 s: bins next to steep flanks read the flank, and those at the
    /// band's edges read what is played half a bin beyond and nothing further. A model with a rate
    /// of its own is read as it is played at high rates: the RMS is then [`Self::played_part`].
    ///
    /// A voice plays its model's magnitude as a density; that of a model that keeps energies
    /// ([`keeps_level`](htex_model::Descriptor::keeps_level)) plays it [sharpened](sharpen). The
    /// magnitude of sinusoids is already what is read, as far as the window's main lobe goes.
    ///
    /// # Errors
    /// As [`Self::magnitude`].
    pub fn read_magnitude(&self, parameters: &[f64], band: Band) -> Result<Vec<f64>, HostError> {
        let grid = band.grid_hz();
        if self.has_lines() || grid.is_empty() {
            return self.magnitude(parameters, band, &grid);
        }
        let (mut read, rms) = match self.own_rate(parameters, band)? {
            None => {
                let read = self.read(parameters, band, &grid, &|_| 1.0, f64::INFINITY)?;
                let rms = level_rms(&read);
                (read, rms)
            }
            Some(own) => {
                let half_hz = 0.5 * own.rate_hz();
                let before = |hz: f64| f64::from(u8::from(hz <= half_hz));
                let before = self.read(parameters, band, &grid, &before, half_hz)?;
                let whole_hz = BELOW_OWN_RATE * own.rate_hz();
                let passed = |hz: f64| if hz > whole_hz { own.amplitude(hz).abs() } else { 1.0 };
                let read = self.read(parameters, band, &grid, &passed, half_hz)?;
                (read, level_rms(&before))
            }
        };
        if rms > 0.0 {
            read.iter_mut().for_each(|m| *m /= rms);
        }
        Ok(read)
    }

    /// Returns the part of its level that a voice is played at, as the bins of the band read it:
    /// below 1 where the model has a rate of its own and the conversion to the player's rate takes
    /// away power near half of it (about 0.7 where all of it lies there).
    ///
    /// # Errors
    /// As [`Self::magnitude`].
    pub fn played_part(&self, parameters: &[f64], band: Band) -> Result<f64, HostError> {
        if self.has_lines() || self.own_rate(parameters, band)?.is_none() {
            return Ok(1.0);
        }
        let part = level_rms(&self.read_magnitude(parameters, band)?);
        Ok(if part > 0.0 { part } else { 1.0 })
    }

    /// What is passed of a voice with a rate of its own, where its band reaches up to half that
    /// rate.
    fn own_rate(&self, parameters: &[f64], band: Band) -> Result<Option<OwnRate>, HostError> {
        let rate_hz = self.voice_rate_hz(parameters, band, HIGH_RATE_HZ)?;
        Ok(OwnRate::new(rate_hz, band.high_hz))
    }

    /// Reads a voice's density through the window, at each bin: of what has `amplitude` at a
    /// frequency, hertz. Above `half_hz`, half of the voice's own rate, is the image of what is
    /// below.
    fn read(
        &self,
        parameters: &[f64],
        band: Band,
        grid: &[f64],
        amplitude: &dyn Fn(f64) -> f64,
        half_hz: f64,
    ) -> Result<Vec<f64>, HostError> {
        // Positions in the window's main lobe, in bins, and their weights.
        let place = |i: i32| f64::from(i) / f64::from(IN_BIN);
        let lobe: Vec<(f64, f64)> = (-2 * IN_BIN..=2 * IN_BIN)
            .map(|i| (place(i), hann_main_lobe(place(i)).powi(2)))
            .collect();
        let places: Vec<f64> =
            grid.iter().flat_map(|hz| lobe.iter().map(move |(d, _)| hz + d * GRID_HZ)).collect();
        let source_hz = |hz: &f64| if *hz > half_hz { 2.0 * half_hz - hz } else { *hz };
        let dense: Vec<f64> = places.iter().map(|hz| played_at(band, source_hz(hz))).collect();
        let mut density = if self.descriptor().keeps_level {
            sharpened(&self.magnitude(parameters, band, grid)?, band, &dense)
        } else {
            self.magnitude(parameters, band, &dense)?
        };
        let all = density.iter_mut().zip(&places);
        all.for_each(|(m, hz)| *m *= amplitude(*hz));
        let power = |part: &[f64]| -> f64 {
            let weighed = part.iter().zip(&lobe).map(|(m, (_, weight))| weight * m * m);
            weighed.sum()
        };
        let powers = density.chunks(lobe.len()).map(power);
        Ok(powers.map(f64::sqrt).collect())
    }
}

/// Returns the frequency in the band that is played at a frequency: beyond an edge, that of the
/// edge for half a bin.
fn played_at(band: Band, hz: f64) -> f64 {
    let edge_hz = hz.clamp(band.low_hz, band.high_hz);
    if (hz - edge_hz).abs() <= BESIDE_EDGE_BINS * GRID_HZ { edge_hz } else { hz.max(0.0) }
}

/// Returns the density of a sharpened magnitude, given on the band's grid, at frequencies in hertz:
/// linear between bins, 0 outside the band.
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
