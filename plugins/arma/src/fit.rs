//! Estimation of poles and zeros from a power spectrum.
//!
//! Poles and zeros depend on each other, so the fit estimates them alternately, in several rounds.
//! For the poles, the fit divides the spectrum by the spectrum of the zeros and applies the
//! Yule–Walker method. For the zeros, the fit inverts the spectrum, multiplies it by the spectrum
//! of the poles, and again applies the Yule–Walker method. After each round, the fit computes the
//! Itakura–Saito distance between the recorded spectrum and the filter's spectrum, at the level
//! that minimises this distance. The fit keeps the round with the smallest distance. If the
//! recording is Gaussian noise, the parameters of this round have the largest likelihood of all
//! rounds. The fit makes no resonance narrower than a bin, because the spectrum cannot show such a
//! resonance.

use alloc::vec::Vec;

use htex_dsp::grid::{Band, GRID_HZ, level_rms};
use htex_dsp::line_spectrum::lines_of_reflection;
use htex_dsp::linear_prediction::{
    ar_magnitude, levinson_durbin, step_down_in_place, within_radius,
};
use htex_model::{Error, Fit, FitInput};

use crate::filter::Filter;

const POLES: usize = 0;
const ZEROS: usize = 1;
const RATE: usize = 2;
/// Half-power width of the narrowest resonance of a fit, hertz.
const NARROWEST_HZ: f64 = GRID_HZ;
/// Number of rounds in which poles and zeros are estimated.
const ROUNDS: usize = 12;
/// Smallest power of a bin, relative to the largest bin. Without this limit, an empty bin would
/// dominate the inverse spectrum.
const FLOOR: f64 = 1e-8;

pub(crate) fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
    let largest = input.magnitude.iter().fold(0.0f64, |a, &m| a.max(m));
    if largest == 0.0 {
        return Err(Error::cannot_fit("the spectrum is silent: there is no filter to find"));
    }
    // A recording whose band ends below the tactile band was sampled at twice the band's upper
    // edge.
    let rate_hz = if input.band.high_hz < Band::TACTILE.high_hz {
        input.options[RATE].min(2.0 * input.band.high_hz)
    } else {
        input.options[RATE]
    };
    let spectrum = Spectrum::new(input, largest, rate_hz);
    let orders = [POLES, ZEROS].map(|option| input.options[option] as usize);
    let (poles, zeros) = spectrum.likeliest(orders);
    let (poles, zeros) = (stored_lines(&poles)?, stored_lines(&zeros)?);
    let parameters =
        [&[poles.len() as f64], &poles[..], &[zeros.len() as f64], &zeros, &[rate_hz]].concat();
    let filter = Filter::of_lines(&poles, &zeros, rate_hz).map_err(|_| too_close())?;
    filter.level(input.band)?;
    // The magnitudes are relative to the largest bin, so that no power overflows or underflows.
    let relative: Vec<f64> = input.magnitude.iter().map(|m| m / largest).collect();
    Ok(Fit { parameters, level_rms: largest * level_rms(&relative) })
}

/// Returns the line spectral frequencies of a stable polynomial, rounded as files store them.
fn stored_lines(coefficients: &[f64]) -> Result<Vec<f64>, Error> {
    let mut reflection = coefficients.to_vec();
    if !step_down_in_place(&mut reflection) {
        return Err(too_close());
    }
    let stored = |line: f64| f64::from(line as f32);
    Ok(lines_of_reflection(&reflection).map(stored).collect())
}

fn too_close() -> Error {
    Error::cannot_fit(
        "the poles are too close to each other and to the unit circle for 32-bit floats; choose fewer, or a lower rate_hz",
    )
}

/// Power of the bins up to the Nyquist frequency, relative to the largest bin. Bins below the band
/// get the power of the band's first bin, because empty bins would attract zeros.
struct Spectrum {
    frequency_hz: Vec<f64>,
    power: Vec<f64>,
    /// Weight of each bin in correlations: one half at 0 Hz and at the Nyquist frequency, because
    /// these bins are their own mirror images.
    part: Vec<f64>,
    rate_hz: f64,
}

impl Spectrum {
    fn new(input: &FitInput<'_>, largest: f64, rate_hz: f64) -> Self {
        let first = input.frequency_hz.first().copied().unwrap_or(0.0);
        let below = (0..)
            .map(|bin| f64::from(bin) * GRID_HZ)
            .take_while(|hz| *hz < first - 0.5 * GRID_HZ)
            .map(|hz| (hz, input.magnitude.first().copied().unwrap_or(0.0)));
        let own = input.frequency_hz.iter().copied();
        let all = below
            .chain(own.zip(input.magnitude.iter().copied()))
            .filter(|(hz, _)| *hz <= 0.5 * rate_hz);
        let power = |m: f64| ((m / largest) * (m / largest)).max(FLOOR);
        let (frequency_hz, power): (Vec<f64>, _) = all.map(|(hz, m)| (hz, power(m))).unzip();
        let is_mirrored = |hz: &f64| *hz > 0.0 && *hz < 0.5 * rate_hz;
        let part = |hz: &f64| if is_mirrored(hz) { 1.0 } else { 0.5 };
        Self { part: frequency_hz.iter().map(part).collect(), frequency_hz, power, rate_hz }
    }

    /// Returns the most likely poles and zeros with these orders.
    fn likeliest(&self, [poles, zeros]: [usize; 2]) -> (Vec<f64>, Vec<f64>) {
        let mut above = Vec::new();
        let mut best = (f64::INFINITY, Vec::new(), Vec::new());
        let rounds = if zeros == 0 { 1 } else { ROUNDS };
        for _ in 0..rounds {
            let numerator = self.inverse_power(&above);
            let below = self.poles_of(|i| self.power[i] * numerator[i], poles);
            let denominator = self.inverse_power(&below);
            above = self.poles_of(|i| denominator[i] / self.power[i], zeros);
            let distance = self.distance(&denominator, &self.inverse_power(&above));
            // The first round is kept even if its distance is NaN, so that there is always a
            // result.
            if distance < best.0 || best.0 == f64::INFINITY {
                best = (distance, below, above.clone());
            }
        }
        (best.1, best.2)
    }

    /// Returns `1 / |1 - Σ A_i z⁻ⁱ|²` at the bins.
    fn inverse_power(&self, coefficients: &[f64]) -> Vec<f64> {
        let at = |hz: &f64| {
            let m = ar_magnitude(coefficients, *hz, self.rate_hz);
            m * m
        };
        self.frequency_hz.iter().map(at).collect()
    }

    /// Returns the all-pole filter of a power spectrum, by Yule–Walker.
    fn poles_of(&self, power: impl Fn(usize) -> f64, order: usize) -> Vec<f64> {
        let largest = (0..self.power.len()).map(&power).fold(0.0, f64::max);
        let lag = |lag: usize| -> f64 {
            let turn = core::f64::consts::TAU * lag as f64 / self.rate_hz;
            let bins = self.frequency_hz.iter().enumerate();
            bins.map(|(i, hz)| self.part[i] * power(i) / largest * htex_dsp::trig::cos(turn * hz))
                .sum()
        };
        let lags: Vec<f64> = (0..=order).map(lag).collect();
        let radius = libm::exp(-core::f64::consts::PI * NARROWEST_HZ / self.rate_hz);
        within_radius(&levinson_durbin(&lags, order).coefficients, radius)
    }

    /// Returns the Itakura–Saito distance of the spectrum from the spectrum of a filter at its best
    /// level, up to a constant. It is computed from the ratios of both powers: the logarithm of the
    /// mean ratio, minus the mean of the logarithms.
    fn distance(&self, denominator: &[f64], numerator: &[f64]) -> f64 {
        let filter = denominator.iter().zip(numerator).map(|(d, n)| d / n);
        let ratios: Vec<f64> = self.power.iter().zip(filter).map(|(p, h)| p / h).collect();
        let count = ratios.len() as f64;
        let mean: f64 = ratios.iter().sum::<f64>() / count;
        libm::log(mean) - ratios.iter().map(|r| libm::log(*r)).sum::<f64>() / count
    }
}
