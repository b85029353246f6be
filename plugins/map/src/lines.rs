//! The spectrum along the rows: a line for each whole number of waves in the width of the map.

use alloc::vec::Vec;

use htex_dsp::grid::{Band, GRID_HZ, curve_level_rms};
use htex_dsp::window::hann_main_lobe;
use htex_model::{Error, text};

use crate::map::Map;

/// Smallest RMS, in grey values: rounding of a map without differences is below, and a pixel that
/// differs by one is above.
const LEAST: f64 = 1e-9;
/// Largest difference of the stated RMS from that of the grey values, in the latter: assets store
/// 32-bit floats.
const TOLERANCE: f64 = 1e-6;
/// Half of the width of the window's main lobe, hertz.
const LOBE_HZ: f64 = 2.0 * GRID_HZ;

/// Mean squares of the lines in the band, over all rows.
pub(crate) struct Lines {
    fundamental_hz: f64,
    /// Of one wave in the width, two, and so on, as the voice plays them; 0 outside the band.
    power: Vec<f64>,
    /// RMS of all, as the Hann window reads it in the band.
    pub(crate) rms: f64,
}

impl Lines {
    /// Those of a map that states its RMS.
    ///
    /// # Errors
    /// As [`Self::of`], and when the stated RMS is not that of the grey values.
    pub(crate) fn stated(map: &Map<'_>, band: Band) -> Result<Self, Error> {
        let lines = Self::of(map, band)?;
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

    /// # Errors
    /// When no line with a power lies in the band.
    pub(crate) fn of(map: &Map<'_>, band: Band) -> Result<Self, Error> {
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

    /// RMS of the lines behind a filter that passes parts of their power, over that before it.
    pub(crate) fn rms_behind(&self, passed: impl Fn(f64) -> f64) -> f64 {
        let behind =
            |(i, power): (usize, &f64)| power * passed((i + 1) as f64 * self.fundamental_hz);
        let all: f64 = self.power.iter().sum();
        libm::sqrt(self.power.iter().enumerate().map(behind).sum::<f64>() / all)
    }

    /// Magnitude of unit RMS as the Hann window measures it; powers are added.
    pub(crate) fn seen_at(&self, frequency_hz: f64) -> f64 {
        // Those in the window's main lobe.
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

/// Mean square of the waves of a number in the width, over all rows.
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
                turn += waves;
                turn -= if turn < width { 0 } else { width };
            }
            re * re + im * im
        })
        .sum();
    // A wave at half of the pixels' rate is its own mirror image.
    let sides = if 2 * waves == width { 1.0 } else { 2.0 };
    sides * power / (count * (width * width) as f64)
}

/// Part of the power of waves, in cycles a pixel, that the cubic between pixels passes (Keys 1981,
/// equation 18 with a = -1/2).
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
