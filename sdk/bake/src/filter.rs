//! Symmetrical filters with a magnitude.

use std::f64::consts::PI;

/// Rounds in which the filter's response is compared with the magnitude.
const ROUNDS: usize = 12;
/// Range of the correction of a magnitude.
const CORRECTION: (f64, f64) = (0.1, 10.0);
/// Shape of the Kaiser window of the coefficients.
const WINDOW: f64 = 3.0;
/// Largest distance of the frequencies at which filters are designed, hertz.
const SPACING_HZ: f64 = 1.25;
/// Fewest frequencies, four for each coefficient of the longest filter.
const FEWEST: usize = 1280;

/// The frequencies at which filters of a rate are designed and read, evenly spaced from 0 to half the rate.
pub(crate) struct Design {
    rate_hz: f64,
    /// Cosines of a cycle divided by twice the number of frequencies.
    cosine: Vec<f64>,
    steps: usize,
}

impl Design {
    pub(crate) fn new(rate_hz: f64) -> Self {
        let steps = ((0.5 * rate_hz / SPACING_HZ).ceil() as usize).max(FEWEST);
        let cosine = (0..2 * steps).map(|i| (PI * i as f64 / steps as f64).cos());
        Self {
            rate_hz,
            cosine: cosine.collect(),
            steps,
        }
    }

    /// Returns the frequencies, hertz.
    pub(crate) fn frequencies_hz(&self) -> Vec<f64> {
        let step_hz = 0.5 * self.rate_hz / self.steps as f64;
        (0..=self.steps).map(|i| i as f64 * step_hz).collect()
    }

    /// Designs the centre and one side of a filter of unit energy, with the magnitude at the design's frequencies, by
    /// frequency sampling: the wanted magnitude is divided by the response and the filter designed again.
    pub(crate) fn filter(&self, magnitude: &[f64], half: usize) -> Vec<f64> {
        let window = window(half);
        let mut wanted = magnitude.to_vec();
        let mut side = self.sampled(&wanted, &window);
        for _ in 0..ROUNDS {
            let response = self.response(&side);
            for ((w, m), r) in wanted.iter_mut().zip(magnitude).zip(&response) {
                let (least, most) = (m * CORRECTION.0, m * CORRECTION.1);
                // A response near zero would correct by all of the range in one round.
                *w = (*w * m / r.abs().max(0.5 * m + f64::MIN_POSITIVE)).clamp(least, most);
            }
            side = self.sampled(&wanted, &window);
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

    /// Returns the response of a filter at the design's frequencies.
    pub(crate) fn response(&self, side: &[f64]) -> Vec<f64> {
        let at = |bin: usize| {
            let pairs = side.iter().enumerate().skip(1);
            side[0] + 2.0 * pairs.map(|(lag, c)| c * self.cosine(bin, lag)).sum::<f64>()
        };
        (0..=self.steps).map(at).collect()
    }

    /// Returns the power per hertz of unit white noise through a filter, at any frequency.
    pub(crate) fn density(&self, side: &[f64], hz: f64) -> f64 {
        let turn = 2.0 * PI * hz / self.rate_hz;
        let pairs = side.iter().enumerate().skip(1);
        let sum: f64 = pairs.map(|(lag, c)| c * (turn * lag as f64).cos()).sum();
        let response = side[0] + 2.0 * sum;
        2.0 * response * response / self.rate_hz
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
