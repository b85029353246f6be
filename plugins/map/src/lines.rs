//! The spectrum along the rows: a line for each whole number of waves in the width of the map.

use alloc::vec::Vec;

use htex_dsp::grid::{Band, GRID_HZ};
use htex_dsp::window::hann_main_lobe;
use htex_model::{Error, text};

use crate::map::Map;

/// Mean squares of the lines in the band, over all rows.
pub(crate) struct Lines {
    fundamental_hz: f64,
    /// Of one wave in the width, two, and so on, as the voice plays them; 0 outside the band.
    power: Vec<f64>,
    /// RMS of all.
    pub(crate) rms: f64,
}

impl Lines {
    /// # Errors
    /// When no line with a power lies in the band.
    pub(crate) fn of(map: &Map<'_>, band: Band) -> Result<Self, Error> {
        let fundamental_hz = map.fundamental_hz();
        let most = map.width / 2;
        let inside = |waves: usize| band.contains(waves as f64 * fundamental_hz);
        let power: Vec<f64> = (1..=most)
            .map(|waves| match inside(waves) {
                true => mean_square(map, waves) * passed(waves as f64 / map.width as f64),
                false => 0.0,
            })
            .collect();
        let rms = libm::sqrt(power.iter().sum());
        // The squares of smaller values would underflow.
        if rms > 1e-100 {
            return Ok(Self {
                fundamental_hz,
                power,
                rms,
            });
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

    /// Magnitude of unit RMS as the Hann window measures it; powers are added.
    pub(crate) fn seen_at(&self, frequency_hz: f64) -> f64 {
        let lines = self.power.iter().enumerate();
        let power: f64 = lines
            .map(|(i, power)| {
                let line_hz = (i + 1) as f64 * self.fundamental_hz;
                let seen = hann_main_lobe((frequency_hz - line_hz) / GRID_HZ);
                2.0 * power * seen * seen
            })
            .sum();
        libm::sqrt(power) / self.rms
    }
}

/// Mean square of the waves of a number in the width, over all rows.
fn mean_square(map: &Map<'_>, waves: usize) -> f64 {
    let width = map.width;
    let step = core::f64::consts::TAU * waves as f64 / width as f64;
    let turns: Vec<(f64, f64)> = (0..width)
        .map(|x| (libm::cos(step * x as f64), libm::sin(step * x as f64)))
        .collect();
    let rows = map.grey.chunks_exact(width);
    let count = rows.len() as f64;
    let power: f64 = rows
        .map(|row| {
            let (mut re, mut im) = (0.0, 0.0);
            for (grey, (cos, sin)) in row.iter().zip(&turns) {
                re += grey * cos;
                im += grey * sin;
            }
            re * re + im * im
        })
        .sum();
    // A wave at half of the pixels' rate is its own mirror image.
    let sides = if 2 * waves == width { 1.0 } else { 2.0 };
    sides * power / (count * (width * width) as f64)
}

/// Part of the power of waves, in cycles a pixel, that the cubic between pixels passes (Keys 1981, equation 18 with a = -1/2).
fn passed(cycles: f64) -> f64 {
    let sinc = |x: f64| {
        let a = core::f64::consts::PI * x;
        if a == 0.0 { 1.0 } else { libm::sin(a) / a }
    };
    let (f, w) = (cycles, core::f64::consts::PI * cycles);
    let one = 3.0 / (w * w) * (sinc(f) * sinc(f) - sinc(2.0 * f));
    let two =
        1.0 / (w * w) * (3.0 * sinc(2.0 * f) * sinc(2.0 * f) - 2.0 * sinc(2.0 * f) - sinc(4.0 * f));
    let gain = one - two;
    gain * gain
}
