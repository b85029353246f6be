//! Design of symmetrical filters with a given magnitude.

use htex_dsp::fft::RealFft;
use htex_dsp::grid::GRID_HZ;
use htex_dsp::window::hann_main_lobe;
use htex_host::Band;

use crate::bake::reading::Bands;

/// Number of rounds in which the filter's spectrum is compared with the wanted spectrum and
/// corrected.
const ROUNDS: usize = 80;
/// The rounds end when the relative correction of every bin is below this.
const SMALL: f64 = 0.003;
/// Range to which the correction of a magnitude is limited.
const CORRECTION: (f64, f64) = (0.05, 20.0);
/// Shape parameter of the Kaiser window of the coefficients.
const WINDOW: f64 = 2.0;
/// Largest distance between frequencies at which filters are designed, in bins.
const SPACING: f64 = 0.25;
/// Smallest and largest number of these frequencies. Both are powers of two. The longest filter has
/// more than three of these frequencies per coefficient.
const STEPS: (usize, usize) = (2048, 8192);

/// The frequencies at which the filters for one rate are designed and measured, evenly spaced from
/// 0 to half the rate.
#[derive(Clone)]
pub(crate) struct Design {
    rate_hz: f64,
    steps: usize,
    fft: RealFft,
}

impl Design {
    /// Makes a design for bins that are at least `spacing_hz` apart.
    pub(crate) fn new(rate_hz: f64, spacing_hz: f64) -> Self {
        let wanted = (0.5 * rate_hz / (SPACING * spacing_hz)).ceil() as usize;
        let steps = wanted.next_power_of_two().clamp(STEPS.0, STEPS.1);
        Self { rate_hz, steps, fft: RealFft::new(2 * steps) }
    }

    /// Returns whether both designs make the same filters.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        (self.rate_hz, self.steps) == (other.rate_hz, other.steps)
    }

    pub(crate) fn frequencies_hz(&self) -> Vec<f64> {
        (0..=self.steps).map(|i| self.hz(i)).collect()
    }

    /// Designs a filter of unit energy by frequency sampling, and returns its centre and one side.
    ///
    /// The wanted magnitude is given at the design's frequencies. In each round, the spectrum of
    /// the filter is measured at the bins, as a recording would be, and compared with the `stated`
    /// spectrum. Then the magnitude is corrected and the filter is designed again. The filter with
    /// the smallest error of the nine bands is returned.
    pub(crate) fn filter(&mut self, wanted: &Target, bins: &Bins, half: usize) -> Vec<f64> {
        let window = window(half);
        let mut magnitude = wanted.magnitude.clone();
        let mut side = self.sampled(&magnitude, &window);
        // The error may rise again in a later round, so the best filter is remembered.
        let mut best = (f64::INFINITY, side.clone());
        for _ in 0..=ROUNDS {
            let read = bins.read(&self.response(&side));
            let rms = htex_dsp::grid::level_rms(&read);
            if !(rms > 0.0 && rms.is_finite()) {
                break;
            }
            // Only the shape is compared here, because the level is stored separately.
            let unit: Vec<f64> = read.iter().map(|m| m / rms).collect();
            let error_db = wanted.bands.distance_db(wanted.stated, &unit);
            if error_db < best.0 {
                best = (error_db, side.clone());
            }
            let ratio = |(stated, read): (&f64, &f64)| {
                // A bin that the filter hardly reaches must not change by orders of magnitude in
                // one round. The limits also cover a bin that reads as zero.
                if *stated > 0.0 { (stated / read).clamp(0.5, 2.0) } else { 1.0 }
            };
            let corrections: Vec<f64> = wanted.stated.iter().zip(&unit).map(ratio).collect();
            if corrections.iter().all(|c| (c - 1.0).abs() < SMALL) {
                break;
            }
            for (i, (m, original)) in magnitude.iter_mut().zip(&wanted.magnitude).enumerate() {
                let (least, most) = (original * CORRECTION.0, original * CORRECTION.1);
                *m = (*m * bins.between(&corrections, self.hz(i))).clamp(least, most);
            }
            side = self.sampled(&magnitude, &window);
        }
        let mut side = best.1;
        let energy = energy(&side);
        let scale = if energy > 0.0 { 1.0 / energy.sqrt() } else { 0.0 };
        side.iter_mut().for_each(|c| *c *= scale);
        side
    }

    fn hz(&self, i: usize) -> f64 {
        0.5 * self.rate_hz * i as f64 / self.steps as f64
    }

    fn sampled(&mut self, magnitude: &[f64], window: &[f64]) -> Vec<f64> {
        // A spectrum without phase gives a filter that is symmetrical about sample 0.
        let mut bins = self.fft.make_bins();
        for (bin, m) in bins.iter_mut().zip(magnitude) {
            bin.re = *m;
        }
        let mut samples = vec![0.0; 2 * self.steps];
        self.fft.inverse(&bins, &mut samples);
        // The inverse transform does not divide by its length.
        let scale = 0.5 / self.steps as f64;
        let windowed = window.iter().zip(&samples);
        windowed.map(|(w, x)| w * x * scale).collect()
    }

    /// Returns the response of a filter at the frequencies of the design.
    pub(crate) fn response(&mut self, side: &[f64]) -> Vec<f64> {
        let mut samples = vec![0.0; 2 * self.steps];
        for (lag, c) in side.iter().enumerate() {
            samples[lag] = *c;
            // Lag 0 is its own mirror image.
            let mirrored = (2 * self.steps - lag) % (2 * self.steps);
            samples[mirrored] = *c;
        }
        let mut bins = self.fft.make_bins();
        self.fft.forward(&samples, &mut bins);
        bins.iter().map(|bin| bin.re).collect()
    }
}

/// Returns the energy of a filter, given its centre and one side.
pub(crate) fn energy(side: &[f64]) -> f64 {
    let sum: f64 = side.iter().map(|c| c * c).sum();
    // The centre has no mirror image.
    2.0 * sum - side.first().map_or(0.0, |centre| centre * centre)
}

/// The spectrum that a filter must have.
pub(crate) struct Target<'a> {
    /// Magnitude at the frequencies of the design.
    pub(crate) magnitude: Vec<f64>,
    /// Magnitude at unit RMS at the bins.
    pub(crate) stated: &'a [f64],
    /// The bands in which spectra are compared.
    pub(crate) bands: &'a Bands,
}

/// Computes the bins that a Hann window would measure from noise with a filter's response. The
/// frequencies of the bins are multiplied by a ratio.
pub(crate) struct Bins {
    first_hz: f64,
    spacing_hz: f64,
    /// For each bin: the first of the design's frequencies that the window reaches, and the weights
    /// of the power at this and the following frequencies.
    reaches: Vec<(usize, Vec<f64>)>,
}

impl Bins {
    pub(crate) fn new(design: &Design, band: Band, ratio: f64) -> Self {
        let spacing_hz = GRID_HZ * ratio;
        let reach = 2.0 * spacing_hz;
        let index = |hz: f64| (hz / design.hz(1)).clamp(0.0, design.steps as f64) as usize;
        // A bin contains the power of its width, and the sum of squared magnitudes is three times
        // the power.
        let density = 3.0 * spacing_hz * 2.0 / design.rate_hz;
        let at = |hz: f64| {
            let first = index(hz - reach);
            let range = first..=index(hz + reach);
            let lobe = range.map(|i| hann_main_lobe((design.hz(i) - hz) / spacing_hz).powi(2));
            let mut weights: Vec<f64> = lobe.collect();
            // At 0 Hz and at half the rate the lobe is cut off, so the weights are normalised by
            // the sum of the remaining part.
            let scale = density / weights.iter().sum::<f64>();
            weights.iter_mut().for_each(|weight| *weight *= scale);
            (first, weights)
        };
        let hz = band.grid_hz();
        Self {
            first_hz: hz.first().map_or(0.0, |hz| hz * ratio),
            spacing_hz,
            reaches: hz.into_iter().map(|hz| at(hz * ratio)).collect(),
        }
    }

    /// Returns, at the bins, the magnitude of white noise with unit variance after it has passed
    /// through a filter with this response.
    pub(crate) fn read(&self, response: &[f64]) -> Vec<f64> {
        let at = |(first, weights): &(usize, Vec<f64>)| {
            let reached = response[*first..].iter().zip(weights);
            reached.map(|(r, weight)| weight * r * r).sum::<f64>().sqrt()
        };
        self.reaches.iter().map(at).collect()
    }

    /// Returns the value at a frequency, interpolated between the bins. It is constant beyond the
    /// outermost bins.
    fn between(&self, values: &[f64], hz: f64) -> f64 {
        let last = (values.len().max(1) - 1) as f64;
        let place = ((hz - self.first_hz) / self.spacing_hz).clamp(0.0, last);
        let at = |i: usize| values.get(i).or(values.last()).copied().unwrap_or(1.0);
        let below = place as usize;
        at(below) + place.fract() * (at(below + 1) - at(below))
    }
}

/// Returns one half of a Kaiser window, from its centre outwards.
fn window(half: usize) -> Vec<f64> {
    let at = |lag: usize| {
        let x = lag as f64 / (half + 1) as f64;
        bessel(WINDOW * (1.0 - x * x).sqrt()) / bessel(WINDOW)
    };
    (0..=half).map(at).collect()
}

/// Returns the modified Bessel function of the first kind and order 0, computed by its series.
pub(crate) fn bessel(x: f64) -> f64 {
    let (mut sum, mut term) = (1.0, 1.0);
    // The largest argument, of the interpolator's window, is below 7. Its terms vanish long before
    // the last round.
    for k in 1..64 {
        let factor = 0.5 * x / f64::from(k);
        term *= factor * factor;
        sum += term;
    }
    sum
}
