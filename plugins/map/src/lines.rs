//! The spectrum along the rows of a map. The spectrum has one line for each integer number of waves
//! in the width of the map.

use alloc::vec::Vec;

use htex_dsp::grid::{Band, GRID_HZ, curve_level_rms};
use htex_dsp::window::hann_main_lobe;
use htex_model::{Error, text};

use crate::map::Map;

/// Smallest valid RMS, in grey values. In a map without differences, rounding gives a smaller RMS.
/// A map in which one pixel differs by one has a larger RMS.
const LEAST: f64 = 1e-9;
/// Largest relative difference between the stated RMS and the RMS of the grey values. It is not
/// zero because assets store 32-bit floats.
const TOLERANCE: f64 = 1e-6;
/// Half the width of the window's main lobe, hertz.
const LOBE_HZ: f64 = 2.0 * GRID_HZ;

/// Mean squares of the lines in the band, averaged over all rows.
pub(crate) struct Lines {
    fundamental_hz: f64,
    /// Mean squares of the lines with one wave in the width, two waves, and so on, as the voice
    /// plays them. 0 outside the band.
    power: Vec<f64>,
    /// RMS of all lines in the band, as the Hann window measures it.
    pub(crate) rms: f64,
}

impl Lines {
    /// Returns the lines of a map, and checks the RMS that the map states.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::new`]. Also returns an error if the stated RMS differs
    /// from the RMS of the grey values.
    pub(crate) fn stated(map: &Map<'_>, band: Band) -> Result<Self, Error> {
        let lines = Self::new(map, band)?;
        if (map.rms - lines.rms).abs() <= TOLERANCE * lines.rms {
            Ok(lines)
        } else {
            Err(Error::parameters(text![
                "`rms` is ",
                map.rms,
                ", and that of `grey` is ",
                lines.rms
            ]))
        }
    }

    /// Returns the lines of a map.
    ///
    /// # Errors
    /// Returns an error if no line in the band has power.
    pub(crate) fn new(map: &Map<'_>, band: Band) -> Result<Self, Error> {
        let fundamental_hz = map.fundamental_hz();
        let most = map.width / 2;
        let inside = |waves: usize| band.contains(waves as f64 * fundamental_hz);
        let step = core::f64::consts::TAU / map.width as f64;
        let turns: Vec<(f64, f64)> = (0..map.width)
            .map(|x| (libm::cos(step * x as f64), libm::sin(step * x as f64)))
            .collect();
        let power: Vec<f64> = (1..=most)
            .map(|waves| {
                if inside(waves) {
                    mean_square(map, &turns, waves) * passed(waves as f64 / map.width as f64)
                } else {
                    0.0
                }
            })
            .collect();
        let mut lines = Self { fundamental_hz, power, rms: 1.0 };
        lines.rms = curve_level_rms(band, |hz| lines.seen_at(hz));
        if lines.rms > LEAST {
            return Ok(lines);
        }
        Err(Error::parameters(text![
            "along its rows at ",
            map.speed_mm_s,
            " mm/s the map has nothing between ",
            band.low_hz,
            " and ",
            band.high_hz,
            " Hz"
        ]))
    }

    /// Returns the RMS of the lines after a filter, divided by the RMS before the filter. `passed`
    /// returns the part of the power that the filter passes at a frequency in hertz.
    pub(crate) fn rms_behind(&self, passed: impl Fn(f64) -> f64) -> f64 {
        let behind =
            |(i, power): (usize, &f64)| power * passed((i + 1) as f64 * self.fundamental_hz);
        let all: f64 = self.power.iter().sum();
        libm::sqrt(self.power.iter().enumerate().map(behind).sum::<f64>() / all)
    }

    /// Returns the magnitude at unit RMS, as the Hann window measures it. The powers of lines are
    /// added.
    pub(crate) fn seen_at(&self, frequency_hz: f64) -> f64 {
        // Only lines in the window's main lobe contribute.
        let first = libm::ceil((frequency_hz - LOBE_HZ) / self.fundamental_hz).max(1.0);
        let last = libm::floor((frequency_hz + LOBE_HZ) / self.fundamental_hz).max(0.0);
        let waves = first as usize..=(last as usize).min(self.power.len());
        let power: f64 = waves
            .map(|waves| {
                let line_hz = waves as f64 * self.fundamental_hz;
                let seen = hann_main_lobe((frequency_hz - line_hz) / GRID_HZ);
                2.0 * self.power[waves - 1] * seen * seen
            })
            .sum();
        libm::sqrt(power) / self.rms
    }
}

/// Returns the mean square of the wave with this number of periods in the width, averaged over all
/// rows.
fn mean_square(map: &Map<'_>, turns: &[(f64, f64)], waves: usize) -> f64 {
    let width = map.width;
    let rows = map.grey.chunks_exact(width);
    let count = rows.len() as f64;
    let power: f64 = rows
        .map(|row| {
            let (mut re, mut im, mut turn) = (0.0, 0.0, 0);
            for grey in row {
                let (cos, sin) = turns[turn];
                re += grey * cos;
                im += grey * sin;
                // The phase is an integer, so it is exact at the end of a row.
                turn += waves;
                turn -= if turn < width { 0 } else { width };
            }
            re * re + im * im
        })
        .sum();
    // A wave at half the sample rate of the pixels is its own mirror image.
    let sides = if 2 * waves == width { 1.0 } else { 2.0 };
    sides * power / (count * (width * width) as f64)
}

/// Returns the part of a wave's power that the cubic interpolation between pixels passes (Keys
/// 1981, equation 18 with a = -1/2). `cycles` is the frequency of the wave in cycles per pixel.
fn passed(cycles: f64) -> f64 {
    let sinc = |x: f64| {
        let a = core::f64::consts::PI * x;
        if a == 0.0 { 1.0 } else { libm::sin(a) / a }
    };
    let (f, w) = (cycles, core::f64::consts::PI * cycles);
    let two = sinc(2.0 * f);
    let gain = (3.0 * sinc(f) * sinc(f) - two - 3.0 * two * two + sinc(4.0 * f)) / (w * w);
    gain * gain
}
