//! How a signal fluctuates in time. The spectrum of the signal does not show this.
//!
//! Stationary noise with the spectrum of a recording has the recording's average power in every
//! band, at all times. But the recording itself becomes stronger and weaker several times a second,
//! in many bands at the same time. [`Fluctuation`] describes these changes in three ways:
//!
//! - the modulation spectrum: how strongly the power in each third octave rises and falls at 1 to
//!   64 Hz;
//! - the kurtosis, which is 3 for Gaussian noise and larger for a signal with bursts or clicks;
//! - the correlation of band envelopes, which is 0 if the bands fluctuate independently.

use alloc::vec::Vec;

use num_complex::Complex;

use crate::bands::rms;
use crate::fft::RealFft;
use crate::fidelity::THIRD_OCTAVES;
use crate::window::hann_periodic;

/// Length of the shortest signal that can be measured, seconds. In a shorter signal, the lowest
/// modulation octave would have fewer than three bins.
pub const LEAST_S: f64 = 3.0;
/// Length of the part of a signal that is measured, seconds. Only the middle of a longer signal is
/// measured, because a minute is enough for all octaves.
pub const MOST_S: f64 = 60.0;
/// Envelopes are computed at about this sample rate, hertz. The rate is above twice the highest
/// frequency, so it is enough for all envelopes. The computation takes a tenth of the time that it
/// would take at a rate of 20 kHz.
const REDUCED_HZ: f64 = 2500.0;
/// Number of octaves of modulation: 1–2, 2–4, … 32–64 Hz.
pub const OCTAVES: usize = 6;
/// Lowest edge of the third octaves and of the whole band, hertz.
const LOWEST_HZ: f64 = 20.0;
/// Highest edge, hertz.
const HIGHEST_HZ: f64 = 1000.0;
/// Highest edge, relative to half the sample rate.
const OF_NYQUIST: f64 = 0.95;
/// Added to powers before the logarithm.
const TINY: f64 = 1e-12;
/// Edges of the bands whose amplitude envelopes are correlated, hertz.
const WIDE_HZ: [f64; 5] = [LOWEST_HZ, 60.0, 150.0, 400.0, HIGHEST_HZ];

/// How a signal fluctuates.
#[derive(Debug, Clone, PartialEq)]
pub struct Fluctuation {
    /// Modulation spectrum of the mean of all power envelopes, in the octaves from 1 to 64 Hz,
    /// decibels.
    pub together_db: [f64; OCTAVES],
    /// Mean of the modulation spectra of the power envelopes, decibels.
    pub own_db: [f64; OCTAVES],
    /// Kurtosis of the signal between 20 and 1000 Hz; 3 for Gaussian noise.
    pub kurtosis: f64,
    /// Mean Pearson correlation between the amplitude envelopes of four bands (edges: 20, 60, 150,
    /// 400 and 1000 Hz). `None` if fewer than two of these bands lie in the signal's band.
    pub envelope_correlation: Option<f64>,
}

impl Fluctuation {
    /// Measures a signal. Perpendicular `axes` are measured together: the power envelope of a band
    /// is the sum of the axes' envelopes.
    ///
    /// For each third octave from 20 Hz, the function selects the band's bins from the FFT of the
    /// whole signal. The inverse transform of these bins gives the band's analytic signal. The
    /// squared magnitude of this signal is the power envelope. The function divides the envelope by
    /// its mean, subtracts the mean, and applies a Hann window over the whole length. It averages
    /// the power spectrum of the result over the bins of each octave of modulation.
    ///
    /// `None` if the signal is shorter than [`LEAST_S`], silent, or not finite, or if half its
    /// sample rate is below 128 Hz.
    ///
    /// ```
    /// use htex_dsp::fluctuation::Fluctuation;
    /// let tone: Vec<f64> = (0..8000).map(|n| (0.628 * f64::from(n)).sin()).collect();
    /// let steady = Fluctuation::new(&[&tone], 2000.0).unwrap();
    /// // A sinusoid has the kurtosis 1.5.
    /// assert!((steady.kurtosis - 1.5).abs() < 0.01);
    /// ```
    pub fn new(axes: &[&[f64]], rate_hz: f64) -> Option<Self> {
        let len = axes.iter().map(|axis| axis.len()).min()?;
        if (len as f64) < LEAST_S * rate_hz || rate_hz < 256.0 || !rate_hz.is_finite() {
            return None;
        }
        let axes: Vec<&[f64]> = axes.iter().map(|axis| middle(&axis[..len], rate_hz)).collect();
        let mut bands = Bands::new(&axes, axes[0].len(), rate_hz);
        let len = bands.len;
        let highest_hz = HIGHEST_HZ.min(OF_NYQUIST * 0.5 * rate_hz);
        let edge_hz = |k: usize| match k {
            THIRD_OCTAVES => HIGHEST_HZ,
            _ => LOWEST_HZ * libm::exp2(k as f64 / 3.0),
        };
        let window = hann_periodic(len);
        let (mut together, mut own, mut count) = (Vec::new(), [0.0; OCTAVES], 0.0);
        for k in 0..THIRD_OCTAVES {
            let [low, high] = [edge_hz(k), edge_hz(k + 1).min(highest_hz)];
            if low >= high {
                break;
            }
            let mut envelope = bands.power_envelope([low, high]);
            let mean = envelope.iter().sum::<f64>() / len as f64;
            if !(mean > 0.0 && mean.is_finite()) {
                return None;
            }
            envelope.iter_mut().for_each(|power| *power /= mean);
            together.resize(len, 0.0);
            together.iter_mut().zip(&envelope).for_each(|(sum, power)| *sum += power);
            let spectrum = bands.modulation(&mut envelope, &window);
            own.iter_mut().zip(spectrum).for_each(|(sum, power)| *sum += power);
            count += 1.0;
        }
        if count == 0.0 {
            return None;
        }
        together.iter_mut().for_each(|sum| *sum /= count);
        let together = bands.modulation(&mut together, &window);
        let decibels = |power: f64| 10.0 * libm::log10(power + TINY);
        Some(Self {
            together_db: together.map(decibels),
            own_db: own.map(|sum| decibels(sum / count)),
            kurtosis: bands.kurtosis([LOWEST_HZ, highest_hz])?,
            envelope_correlation: bands.envelope_correlation(highest_hz),
        })
    }

    /// Returns the RMS difference of the two modulation spectra, over all twelve values, decibels.
    pub fn error_rms_db(&self, other: &Self) -> f64 {
        let pairs = self.together_db.iter().zip(&other.together_db);
        let differences = pairs.chain(self.own_db.iter().zip(&other.own_db)).map(|(a, b)| a - b);
        rms(&differences.collect::<Vec<_>>())
    }
}

/// Ranges of modulation frequencies, hertz, in which [`envelope_excess`] sums the excess over
/// stationary noise.
const EXCESS_HZ: [[f64; 2]; 2] = [[1.0, 8.0], [8.0, 32.0]];
/// Length of the shortest signal that [`envelope_excess`] can measure, seconds: one period of the
/// slowest modulation.
const LEAST_EXCESS_S: f64 = 1.0;
/// Number of bands of [`envelope_excess`].
pub const EXCESS_BANDS: usize = WIDE_HZ.len() - 1;

/// The excess fluctuation of a band: how much more its amplitude envelope varies than the envelope
/// of stationary Gaussian noise with the same spectrum. The variances are relative to the square of
/// the mean envelope.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnvelopeExcess {
    /// The measured variance minus the expected variance, at 1 to 8 Hz and at 8 to 32 Hz; may be
    /// below 0.
    pub excess: [f64; 2],
    /// The square of the standard error of `excess` for stationary Gaussian noise.
    pub error: [f64; 2],
    /// Power of the signal in the band, in the squared unit of the signal.
    pub power: f64,
}

/// Measures the excess fluctuation in four bands, with the edges 20, 60, 150, 400 and 1000 Hz.
/// Bands above half the sample rate are `None`. If a signal is longer than [`MOST_S`], only its
/// middle is measured.
///
/// The expected variance is exact for Gaussian noise whose period is the length of the signal. Let
/// ρ be the correlation of the band's analytic signal with itself at a delay. Then the covariance
/// of the envelope and its copy at that delay is `₂F₁(−½, −½; 1; |ρ|²) − 1`, relative to the square
/// of their mean (D. Middleton, 1948). So the function computes the expected variance from a
/// formula, and not from random signals with the same spectrum.
///
/// `None` if the signal is shorter than 1 s, silent, or not finite, or if half its
/// sample rate is below 128 Hz.
pub fn envelope_excess(
    signal: &[f64],
    rate_hz: f64,
) -> Option<[Option<EnvelopeExcess>; EXCESS_BANDS]> {
    if (signal.len() as f64) < LEAST_EXCESS_S * rate_hz || rate_hz < 256.0 || !rate_hz.is_finite() {
        return None;
    }
    let signal = middle(signal, rate_hz);
    let mut bands = Bands::new(&[signal], signal.len(), rate_hz);
    let highest_hz = HIGHEST_HZ.min(OF_NYQUIST * 0.5 * rate_hz);
    let mut found = [None; EXCESS_BANDS];
    for (edges, found) in WIDE_HZ.windows(2).zip(&mut found) {
        let band = [edges[0], edges[1].min(highest_hz)];
        if band[0] < band[1] {
            *found = Some(bands.excess(band)?);
        }
    }
    Some(found)
}

/// The part of a signal that is measured.
fn middle(signal: &[f64], rate_hz: f64) -> &[f64] {
    let measured = signal.len().min((MOST_S * rate_hz) as usize);
    let from = (signal.len() - measured) / 2;
    &signal[from..from + measured]
}

/// `₂F₁(−½, −½; 1; u) − 1` for u from 0 to 1; the error is below 4e-5.
fn envelope_covariance(u: f64) -> f64 {
    let (mut coefficient, mut power, mut sum) = (1.0, 1.0, 0.0);
    for n in 1..=32 {
        coefficient *= (f64::from(n) - 1.5) / f64::from(n);
        power *= u;
        sum += coefficient * coefficient * power;
    }
    sum
}

/// The spectra of a signal's axes, from which bands are taken.
struct Bands {
    /// Sample rate of the bands.
    rate_hz: f64,
    /// FFT with the length of the bands' signals.
    fft: RealFft,
    axes: Vec<Vec<Complex<f64>>>,
    bins: Vec<Complex<f64>>,
    len: usize,
}

impl Bands {
    fn new(axes: &[&[f64]], len: usize, rate_hz: f64) -> Self {
        let mut fft = RealFft::new(len);
        let spectrum = |axis: &&[f64]| {
            let axis = &axis[..len];
            let mean = axis.iter().sum::<f64>() / len as f64;
            let centred: Vec<f64> = axis.iter().map(|x| x - mean).collect();
            let mut bins = fft.make_bins();
            fft.forward(&centred, &mut bins);
            bins
        };
        let axes = axes.iter().map(spectrum).collect();
        // If the bins are read as the spectrum of a shorter signal, they give the same signal at a
        // lower rate.
        let reduced = libm::ceil(len as f64 * REDUCED_HZ / rate_hz) as usize;
        let (len, rate_hz) = match reduced {
            reduced if reduced < len => (reduced, rate_hz * reduced as f64 / len as f64),
            _ => (len, rate_hz),
        };
        let fft = RealFft::new(len);
        let bins = fft.make_bins();
        Self { rate_hz, fft, axes, bins, len }
    }

    /// The frequency of a bin, hertz.
    fn hertz(&self, bin: usize) -> f64 {
        bin as f64 * self.rate_hz / self.len as f64
    }

    /// Returns the part of an axis in a band, with its phase turned by `turn`.
    fn filtered(&mut self, axis: usize, [low, high]: [f64; 2], turn: Complex<f64>) -> Vec<f64> {
        for k in 0..self.bins.len() {
            let hz = self.hertz(k);
            let is_inside = hz >= low && hz < high;
            self.bins[k] = if is_inside { self.axes[axis][k] * turn } else { Complex::ZERO };
        }
        let mut samples = alloc::vec![0.0; self.len];
        self.fft.inverse(&self.bins, &mut samples);
        samples.iter_mut().for_each(|x| *x /= self.len as f64);
        samples
    }

    /// The squared magnitude of the analytic signal of a band, summed over the axes.
    fn power_envelope(&mut self, band: [f64; 2]) -> Vec<f64> {
        let mut envelope = alloc::vec![0.0; self.len];
        for axis in 0..self.axes.len() {
            // The band with its phases turned by a quarter turn is the imaginary part of the
            // analytic signal.
            for turn in [Complex::ONE, -Complex::I] {
                let part = self.filtered(axis, band, turn);
                envelope.iter_mut().zip(&part).for_each(|(sum, x)| *sum += x * x);
            }
        }
        envelope
    }

    /// The excess of a band of the first axis; `None` if the band is silent or not finite.
    fn excess(&mut self, band: [f64; 2]) -> Option<EnvelopeExcess> {
        let len = self.len as f64;
        let mut envelope = self.power_envelope(band);
        let power = 0.5 * envelope.iter().sum::<f64>() / len;
        envelope.iter_mut().for_each(|power| *power = crate::root::sqrt(*power));
        let mean = envelope.iter().sum::<f64>() / len;
        let mut covariance = self.correlation(band);
        let most = covariance[0];
        if !(power > 0.0 && mean > 0.0 && most > 0.0 && mean.is_finite() && most.is_finite()) {
            return None;
        }
        // Rounding may raise the ratio above 1.
        covariance.iter_mut().for_each(|u| *u = envelope_covariance((*u / most).min(1.0)));
        envelope.iter_mut().for_each(|x| *x = *x / mean - 1.0);
        let measured = self.forward(&envelope).map(|bin| 2.0 * bin.norm_sqr() / (len * len));
        let measured: Vec<f64> = measured.collect();
        let expected: Vec<f64> =
            self.forward(&covariance).map(|bin| (2.0 * bin.re / len).max(0.0)).collect();
        let mut found = EnvelopeExcess { power, ..EnvelopeExcess::default() };
        for (range, [low, high]) in EXCESS_HZ.into_iter().enumerate() {
            let inside = |k: &usize| (low..high).contains(&self.hertz(*k));
            for k in (0..expected.len()).filter(inside) {
                found.excess[range] += measured[k] - expected[k];
                // The standard deviation of the power of a noise bin equals its mean.
                found.error[range] += expected[k] * expected[k];
            }
        }
        Some(found)
    }

    /// The squared magnitude of the correlation of a band's analytic signal with itself, at each
    /// delay.
    fn correlation(&mut self, [low, high]: [f64; 2]) -> Vec<f64> {
        let mut squared = alloc::vec![0.0; self.len];
        let mut part = alloc::vec![0.0; self.len];
        for turn in [Complex::ONE, -Complex::I] {
            for k in 0..self.bins.len() {
                let hz = self.hertz(k);
                let is_inside = hz >= low && hz < high;
                let power = if is_inside { self.axes[0][k].norm_sqr() } else { 0.0 };
                self.bins[k] = turn * power;
            }
            self.fft.inverse(&self.bins, &mut part);
            squared.iter_mut().zip(&part).for_each(|(sum, x)| *sum += x * x);
        }
        squared
    }

    /// The bins of a real signal.
    fn forward(&mut self, signal: &[f64]) -> impl Iterator<Item = Complex<f64>> + '_ {
        self.fft.forward(signal, &mut self.bins);
        self.bins.iter().copied()
    }

    /// Subtracts the mean of an envelope, and returns its power spectrum, averaged over each
    /// octave.
    fn modulation(&mut self, envelope: &mut [f64], window: &[f64]) -> [f64; OCTAVES] {
        let mean = envelope.iter().sum::<f64>() / self.len as f64;
        envelope.iter_mut().zip(window).for_each(|(x, w)| *x = (*x - mean) * w);
        self.fft.forward(envelope, &mut self.bins);
        let scale = self.rate_hz * window.iter().map(|w| w * w).sum::<f64>();
        core::array::from_fn(|octave| {
            let low = libm::exp2(octave as f64);
            let bins = (0..self.bins.len()).filter(|k| {
                let hz = self.hertz(*k);
                hz >= low && hz < 2.0 * low
            });
            let (sum, count) = bins.fold((0.0, 0.0), |(sum, count), k| {
                (sum + self.bins[k].norm_sqr() / scale, count + 1.0)
            });
            if count > 0.0 { sum / count } else { 0.0 }
        })
    }

    /// The kurtosis of a band, over the samples of all axes.
    fn kurtosis(&mut self, band: [f64; 2]) -> Option<f64> {
        let (mut second, mut fourth) = (0.0, 0.0);
        for axis in 0..self.axes.len() {
            for x in self.filtered(axis, band, Complex::ONE) {
                second += x * x;
                fourth += x * x * x * x;
            }
        }
        let count = (self.axes.len() * self.len) as f64;
        let kurtosis = count * fourth / (second * second);
        kurtosis.is_finite().then_some(kurtosis)
    }

    /// The mean correlation between the amplitude envelopes of all pairs of wide bands.
    fn envelope_correlation(&mut self, highest_hz: f64) -> Option<f64> {
        let bands = WIDE_HZ.windows(2).map(|edges| [edges[0], edges[1].min(highest_hz)]);
        let bands: Vec<[f64; 2]> = bands.filter(|[low, high]| low < high).collect();
        let amplitude = |band| {
            let mut envelope = self.power_envelope(band);
            envelope.iter_mut().for_each(|power| *power = crate::root::sqrt(*power));
            envelope
        };
        let envelopes: Vec<Vec<f64>> = bands.into_iter().map(amplitude).collect();
        let pairs = (0..envelopes.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
        let all: Vec<f64> = pairs
            .map(|(i, j)| crate::bands::pearson_correlation(&envelopes[i], &envelopes[j]))
            .collect();
        (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
    }
}
