//! The magnitude that one would measure in a recording of a voice. This magnitude can differ from
//! the model's magnitude.

use htex_dsp::grid::{GRID_HZ, level_rms};
use htex_dsp::resample::OwnRate;
use htex_dsp::sharpening::sharpen;
use htex_dsp::window::hann_main_lobe;

use crate::model::HIGH_RATE_HZ;
use crate::{Band, HostError, LoadedModel};

/// Number of points per bin at which a magnitude is sampled.
const IN_BIN: i32 = 8;
/// A voice plays up to this distance beyond the edges of its band, in bins: half of the edge bin.
const BESIDE_EDGE_BINS: f64 = 0.5;
/// The resampler passes frequencies unchanged up to this fraction of a source's own rate.
const BELOW_OWN_RATE: f64 = 0.49;

impl LoadedModel {
    /// Returns whether the model's magnitudes describe spectral lines instead of a spectral
    /// density. The magnitude of a spectral line is the value that a measurement with a window
    /// function gives. Sums of sinusoids have lines. Models that follow the motion also have lines:
    /// their samples repeat, because a finger crosses the same surface again and again.
    pub fn has_lines(&self) -> bool {
        self.descriptor().is_sum_of_sines() || self.follows_motion()
    }

    /// Returns the magnitude that a measurement of the voice's samples with a Hann window of 0.2 s
    /// would give. The magnitude is on the band's grid and has unit RMS. A bin next to a steep
    /// flank measures part of the flank. A bin at an edge of the band measures frequencies up to
    /// half a bin beyond the edge. If the model has its own sample rate, the result includes the
    /// effect of resampling to a high rate. The RMS of the result is then [`Self::played_part`]
    /// instead of 1.
    ///
    /// A voice plays its model's magnitude as a density. If the model's parameters determine the
    /// level ([`keeps_level`](htex_model::Descriptor::keeps_level)), the voice plays the magnitude
    /// [sharpened](sharpen). For models with spectral lines ([`Self::has_lines`]), this function
    /// returns the model's magnitude. For a sum of sinusoids, this is the magnitude that the main
    /// lobe of the window function measures.
    ///
    /// # Errors
    /// Returns the errors of [`Self::magnitude`].
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

    /// Returns the fraction of a voice's level that remains after resampling to the player's rate.
    /// The level is measured in the bins of the band. The fraction is 1, except for models with
    /// their own sample rate. For these models, resampling removes power near half of the model's
    /// rate. If all of the power lies there, the fraction is about 0.7.
    ///
    /// # Errors
    /// Returns the errors of [`Self::magnitude`].
    pub fn played_part(&self, parameters: &[f64], band: Band) -> Result<f64, HostError> {
        if self.has_lines() || self.own_rate(parameters, band)?.is_none() {
            return Ok(1.0);
        }
        let part = level_rms(&self.read_magnitude(parameters, band)?);
        Ok(if part > 0.0 { part } else { 1.0 })
    }

    /// Returns which amplitude the rate conversion passes, for a voice that has its own rate and
    /// whose band extends to half of that rate.
    fn own_rate(&self, parameters: &[f64], band: Band) -> Result<Option<OwnRate>, HostError> {
        let rate_hz = self.voice_rate_hz(parameters, band, HIGH_RATE_HZ)?;
        Ok(OwnRate::new(rate_hz, band.high_hz))
    }

    /// Measures a voice's density through the window at each bin. `amplitude` returns the amplitude
    /// at a frequency in hertz. `half_hz` is half of the voice's own rate; above it, the mirror
    /// image of the lower frequencies appears.
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

/// At `hz`, a voice plays the magnitude that the curve has at the returned frequency. If `hz` is up
/// to half a bin beyond an edge of the band, this frequency is the edge.
fn played_at(band: Band, hz: f64) -> f64 {
    let edge_hz = hz.clamp(band.low_hz, band.high_hz);
    if (hz - edge_hz).abs() <= BESIDE_EDGE_BINS * GRID_HZ { edge_hz } else { hz.max(0.0) }
}

/// Sharpens a magnitude that is given on the band's grid, and returns its density at the
/// frequencies `hertz`. The density is linear between bins and 0 outside the band.
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
