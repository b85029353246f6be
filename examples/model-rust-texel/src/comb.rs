//! The comb of lines of given parameters: its measured spectrum, and the lines that are played.

use htex_dsp::GRID_HZ;
use htex_model::{Band, Error, Values, text};

use crate::{AMPLITUDE, JITTER, PITCH, SPEED};

/// Most harmonics.
pub(crate) const HARMONICS: usize = 48;
/// The lines of one harmonic are at the 10, 30, 50, 70 and 90 % quantiles of the normal
/// distribution. The distances between these lines are unequal, so that the sum of the lines is not
/// periodic.
const QUANTILES: [f64; 5] = [
    -1.281_551_565_544_6,
    -0.524_400_512_708_04,
    0.0,
    0.524_400_512_708_04,
    1.281_551_565_544_6,
];
/// Most lines in total.
pub(crate) const LINES: usize = HARMONICS * QUANTILES.len();
/// Smallest spread, hertz. Closer lines would beat so slowly that the mean level would differ from
/// minute to minute.
const LEAST_SPREAD_HZ: f64 = 1.0;

/// The comb in a band, at the speed of the recording. Lines that are less than a bin away from an
/// edge of the band are silent, because the window would spread them outside the band.
pub(crate) struct Comb<'a> {
    fundamental_hz: f64,
    jitter: f64,
    amplitude: &'a [f64],
    band: Band,
    rms: f64,
}

impl<'a> Comb<'a> {
    pub(crate) fn new(parameters: &Values<'a>, band: Band) -> Result<Self, Error> {
        let mut comb = Self {
            fundamental_hz: parameters.scalar(SPEED) / parameters.scalar(PITCH),
            jitter: parameters.scalar(JITTER),
            amplitude: parameters.list(AMPLITUDE),
            band,
            rms: 1.0,
        };
        let mut power = 0.0;
        comb.for_each_line(|_, f, amplitude| {
            let amplitude = amplitude * heard(f, band);
            power += 0.5 * amplitude * amplitude;
        });
        comb.rms = libm::sqrt(power);
        // The squares of smaller amplitudes would underflow.
        if comb.rms > 1e-100 {
            return Ok(comb);
        }
        Err(Error::parameters(text![
            "no harmonic of ",
            comb.fundamental_hz,
            " Hz with an amplitude lies between ",
            band.low_hz,
            " and ",
            band.high_hz,
            " Hz",
        ]))
    }

    /// Calls `line(index, frequency_hz, amplitude)` for each line, including those outside the
    /// band.
    fn for_each_line(&self, mut line: impl FnMut(usize, f64, f64)) {
        let share = 1.0 / libm::sqrt(QUANTILES.len() as f64);
        for (i, &amplitude) in self.amplitude.iter().take(HARMONICS).enumerate() {
            let centre_hz = (i + 1) as f64 * self.fundamental_hz;
            let spread_hz = (self.jitter * centre_hz).max(LEAST_SPREAD_HZ);
            for (j, z) in QUANTILES.iter().enumerate() {
                let f = centre_hz + spread_hz * z;
                line(i * QUANTILES.len() + j, f, share * amplitude);
            }
        }
    }

    /// Returns the magnitude at unit RMS, as the Hann window measures it. The powers of lines are
    /// added.
    pub(crate) fn seen_at(&self, frequency_hz: f64) -> f64 {
        let mut power = 0.0;
        self.for_each_line(|_, f, amplitude| {
            let m = amplitude * heard(f, self.band) * hann_kernel((frequency_hz - f) / GRID_HZ);
            power += m * m;
        });
        libm::sqrt(power) / self.rms
    }

    /// Calls `line(index, cycles_per_mm, amplitude)` for each line of a surface of unit RMS.
    pub(crate) fn for_each_ridge(&self, speed_mm_s: f64, mut line: impl FnMut(usize, f64, f64)) {
        self.for_each_line(|i, f, amplitude| line(i, f / speed_mm_s, amplitude / self.rms));
    }
}

/// Gain of a line at this frequency: 0 up to one bin from an edge of the band, and 1 from two bins
/// on. So lines enter and leave the band without a step when the speed changes.
pub(crate) fn heard(frequency_hz: f64, band: Band) -> f64 {
    let inside_hz = (frequency_hz - band.low_hz).min(band.high_hz - frequency_hz);
    (inside_hz / GRID_HZ - 1.0).clamp(0.0, 1.0)
}

/// Returns the transform of the periodic Hann window, `bins` away from the middle of its main lobe.
/// The value at the middle is 1.
fn hann_kernel(bins: f64) -> f64 {
    let d = bins.abs();
    if d >= 2.0 {
        return 0.0;
    }
    if d < 1e-6 {
        return 1.0;
    }
    if (d - 1.0).abs() < 1e-6 {
        return 0.5;
    }
    let a = core::f64::consts::PI * d;
    libm::sin(a) / (a * (1.0 - d * d))
}
