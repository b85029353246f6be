//! Symmetrical filters with a magnitude.

use std::f64::consts::PI;

use htex_dsp::grid::GRID_HZ;
use htex_dsp::window::hann_main_lobe;
use htex_host::Band;

/// Rounds in which the filter's spectrum is compared with the stated one.
const ROUNDS: usize = 80;
/// Relative correction of all bins at which the rounds end.
const SMALL: f64 = 0.003;
/// Range of the correction of a magnitude.
const CORRECTION: (f64, f64) = (0.05, 20.0);
/// Shape of the Kaiser window of the coefficients.
const WINDOW: f64 = 2.0;
/// Distance of the frequencies at which filters are designed, in bins.
const SPACING: f64 = 0.25;
/// Number of frequencies: at least four for each coefficient of the longest filter.
const STEPS: (usize, usize) = (1280, 8192);

/// The frequencies at which filters of a rate are designed and read, evenly spaced from 0 to half the rate.
#[derive(Clone)]
pub(crate) struct Design {
    rate_hz: f64,
    /// Cosines of a cycle divided by twice the number of frequencies.
    cosine: Vec<f64>,
    steps: usize,
}

impl Design {
    /// Makes a design for bins of at least `spacing_hz`.
    pub(crate) fn new(rate_hz: f64, spacing_hz: f64) -> Self {
        let wanted = 0.5 * rate_hz / (SPACING * spacing_hz);
        let steps = (wanted.ceil() as usize).clamp(STEPS.0, STEPS.1);
        let cosine = (0..2 * steps).map(|i| (PI * i as f64 / steps as f64).cos());
        Self {
            rate_hz,
            cosine: cosine.collect(),
            steps,
        }
    }

    pub(crate) fn frequencies_hz(&self) -> Vec<f64> {
        (0..=self.steps).map(|i| self.hz(i)).collect()
    }

    /// Designs the centre and one side of a filter of unit energy by frequency sampling. `magnitude` is given at the
    /// design's frequencies; its spectrum, read as a recording's, is then compared with the `stated` one at the bins, the
    /// magnitude is corrected, and the filter designed again.
    pub(crate) fn filter(&self, wanted: &Wanted, bins: &Bins, half: usize) -> Vec<f64> {
        let window = window(half);
        let mut magnitude = wanted.magnitude.clone();
        let mut side = self.sampled(&magnitude, &window);
        for _ in 0..ROUNDS {
            let read = bins.read(self, &side);
            let rms = htex_dsp::grid::level_rms(&read);
            if !(rms > 0.0 && rms.is_finite()) {
                break;
            }
            let ratio = |(stated, read): (&f64, &f64)| match *stated > 0.0 {
                true => (stated * rms / read).clamp(0.5, 2.0),
                false => 1.0,
            };
            let corrections: Vec<f64> = wanted.stated.iter().zip(&read).map(ratio).collect();
            if corrections.iter().all(|c| (c - 1.0).abs() < SMALL) {
                break;
            }
            for (i, (m, original)) in magnitude.iter_mut().zip(&wanted.magnitude).enumerate() {
                let (least, most) = (original * CORRECTION.0, original * CORRECTION.1);
                *m = (*m * bins.between(&corrections, self.hz(i))).clamp(least, most);
            }
            side = self.sampled(&magnitude, &window);
        }
        let energy = side[0] * side[0] + 2.0 * side[1..].iter().map(|c| c * c).sum::<f64>();
        let scale = if energy > 0.0 {
            1.0 / energy.sqrt()
        } else {
            0.0
        };
        side.iter_mut().for_each(|c| *c *= scale);
        side
    }

    fn hz(&self, i: usize) -> f64 {
        0.5 * self.rate_hz * i as f64 / self.steps as f64
    }

    fn cosine(&self, bin: usize, lag: usize) -> f64 {
        self.cosine[bin * lag % (2 * self.steps)]
    }

    fn sampled(&self, magnitude: &[f64], window: &[f64]) -> Vec<f64> {
        let last = self.steps;
        let at = |lag: usize| {
            let term = |bin: usize| magnitude[bin] * self.cosine(bin, lag);
            let ends = 0.5 * (term(0) + term(last));
            let audible = (1..last).filter(|&bin| magnitude[bin] > 0.0);
            (ends + audible.map(term).sum::<f64>()) / last as f64
        };
        window
            .iter()
            .enumerate()
            .map(|(lag, w)| w * at(lag))
            .collect()
    }

    /// Returns the response of a filter at one of the design's frequencies.
    fn response(&self, side: &[f64], bin: usize) -> f64 {
        let pairs = side.iter().enumerate().skip(1);
        side[0] + 2.0 * pairs.map(|(lag, c)| c * self.cosine(bin, lag)).sum::<f64>()
    }
}

/// What a filter is to be.
pub(crate) struct Wanted {
    /// Magnitude at the design's frequencies.
    pub(crate) magnitude: Vec<f64>,
    /// Magnitude of unit RMS at the bins.
    pub(crate) stated: Vec<f64>,
}

/// The bins of a spectrum whose frequencies are multiplied by a ratio, as a Hann window reads them.
pub(crate) struct Bins {
    hz: Vec<f64>,
    spacing_hz: f64,
}

impl Bins {
    pub(crate) fn new(band: Band, ratio: f64) -> Self {
        Self {
            hz: band.grid_hz().iter().map(|hz| hz * ratio).collect(),
            spacing_hz: GRID_HZ * ratio,
        }
    }

    /// Returns the magnitude at the bins of unit white noise through a filter.
    pub(crate) fn read(&self, design: &Design, side: &[f64]) -> Vec<f64> {
        let step_hz = design.hz(1);
        let reach = 2.0 * self.spacing_hz;
        let index = |hz: f64| (hz / step_hz).clamp(0.0, design.steps as f64) as usize;
        let last = self.hz.last().map_or(0, |hz| index(hz + reach));
        let power = (0..=last).map(|i| design.response(side, i).powi(2));
        let power: Vec<f64> = power.collect();
        let at = |hz: &f64| {
            let (mut sum, mut weights) = (0.0, 0.0);
            for i in index(hz - reach)..=index(hz + reach) {
                let weight = hann_main_lobe((design.hz(i) - hz) / self.spacing_hz).powi(2);
                sum += weight * power.get(i).copied().unwrap_or(0.0);
                weights += weight;
            }
            // A bin holds the power of its width, and the sum of squared magnitudes is three times the power.
            let density = 2.0 / design.rate_hz * sum / weights;
            (3.0 * self.spacing_hz * density).sqrt()
        };
        self.hz.iter().map(at).collect()
    }

    /// Returns the value at a frequency, interpolated between the bins and constant beyond them.
    fn between(&self, values: &[f64], hz: f64) -> f64 {
        let first = self.hz.first().copied().unwrap_or(0.0);
        let last = (values.len().max(1) - 1) as f64;
        let place = ((hz - first) / self.spacing_hz).clamp(0.0, last);
        let at = |i: usize| values.get(i).or(values.last()).copied().unwrap_or(1.0);
        let below = place as usize;
        at(below) + place.fract() * (at(below + 1) - at(below))
    }
}

/// Returns half of a Kaiser window, from its centre.
fn window(half: usize) -> Vec<f64> {
    let at = |lag: usize| {
        let x = lag as f64 / (half + 1) as f64;
        bessel(WINDOW * (1.0 - x * x).sqrt()) / bessel(WINDOW)
    };
    (0..=half).map(at).collect()
}

/// Returns the modified Bessel function of the first kind and order 0, by its series.
pub(crate) fn bessel(x: f64) -> f64 {
    let (mut sum, mut term) = (1.0, 1.0);
    for k in 1..64 {
        let factor = 0.5 * x / f64::from(k);
        term *= factor * factor;
        sum += term;
    }
    sum
}
