//! Computes a live spectrum of the newest samples during a recording, with the same code that reads
//! textures from recordings.

use std::collections::VecDeque;

use htex_author::{
    Averaging, Recording, SegmentChoice, SpectrumOptions, TextureSpectrum, segment_spectra,
};
use htex_dsp::bands::{BAND_COUNT, BandBank};
use htex_format::Quantity;

/// Length of the signal from which the spectrum is computed, seconds. It has three segments of 0.2
/// s, each overlapping the previous one by half.
const LIVE_S: f64 = 0.4;
/// Level that stands for a magnitude of zero, decibels.
const SILENCE_DB: f64 = -200.0;
/// Factor that converts a sum of squared magnitudes to a squared RMS. The Hann window spreads a
/// sinusoid over several bins, so the sum is 1.5 times the sinusoid's power.
const SQUARED_RMS: f64 = 1.0 / 3.0;

/// The newest 0.4 s of a texture's signal.
///
/// [`Self::spectrum`] computes the same spectrum as `htex fit` would from these samples, but
/// without correcting for the response of the setup. The steps are: remove the mean, apply a Hann
/// window, compute the FFT, reduce the axes to one, and take the root of the mean power.
///
/// ```
/// use htex_format::Quantity;
/// use htex_lab::record::LiveSignal;
///
/// let mut signal = LiveSignal::new(Quantity::LateralForce, 2000.0);
/// assert!(signal.spectrum().is_none());
/// let tone = |i: u32| 0.01 * (std::f64::consts::TAU * 250.0 * f64::from(i) / 2000.0).sin();
/// let samples: Vec<f64> = (0..800).map(tone).collect();
/// signal.push(&[&samples]);
/// let spectrum = signal.spectrum().ok_or("too short")?;
/// // 20, 25, 30 … Hz; 0.01 N is -40 dB relative to 1 N.
/// let (at, peak_db) = spectrum.peak();
/// assert!(at == 250.0 && (peak_db + 40.0).abs() < 1e-6, "{at} Hz, {peak_db} dB");
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone)]
pub struct LiveSignal {
    quantity: Quantity,
    rate_hz: f64,
    axes: Vec<VecDeque<f64>>,
}

/// A spectrum for display.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveSpectrum {
    /// Frequencies, hertz: multiples of 5 Hz from 20 to 1000 Hz, or to half the sample rate.
    pub frequency_hz: Vec<f64>,
    /// Magnitude at each frequency, decibels relative to one unit of the quantity. A sinusoid of
    /// amplitude A at a frequency of the grid has a level of 20 log10 A. The lowest level is -200
    /// dB.
    pub level_db: Vec<f64>,
    /// RMS in each of nine half-overlapping bands, decibels relative to one unit.
    pub band_db: Vec<f64>,
}

impl LiveSignal {
    /// Creates a signal without samples. The rate is in hertz.
    #[must_use]
    pub fn new(quantity: Quantity, rate_hz: f64) -> Self {
        Self { quantity, rate_hz, axes: Vec::new() }
    }

    /// Appends the next samples of each axis.
    pub fn push(&mut self, axes: &[&[f64]]) {
        let most = (LIVE_S * self.rate_hz).round() as usize;
        self.axes.resize_with(axes.len(), VecDeque::new);
        for (newest, samples) in self.axes.iter_mut().zip(axes) {
            newest.extend(samples.iter());
            newest.drain(..newest.len().saturating_sub(most));
        }
    }

    /// Removes all samples.
    pub fn clear(&mut self) {
        self.axes.clear();
    }

    /// Returns the spectrum. Returns `None` if there are less than 0.2 s of samples, or if the
    /// samples are not a valid recording, for example because a sample is infinite.
    #[must_use]
    pub fn spectrum(&self) -> Option<LiveSpectrum> {
        let axes = self.axes.iter().map(|axis| axis.iter().copied().collect());
        let recording =
            Recording::from_axes(self.quantity, "", self.rate_hz, axes.collect()).ok()?;
        let options = SpectrumOptions::default().with_segments(SegmentChoice::Windows);
        let segments = segment_spectra(&recording, &options).ok()?;
        let texture = TextureSpectrum::average(&[segments], Averaging::Rms).ok()?;
        Some(LiveSpectrum::from_texture(&texture))
    }
}

impl LiveSpectrum {
    /// Converts a texture's spectrum to decibels.
    pub(crate) fn from_texture(texture: &TextureSpectrum) -> Self {
        let bank = BandBank::new(BAND_COUNT, texture.band, &texture.frequency_hz);
        let energies = bank.energies(&texture.magnitude);
        let rms = energies.iter().map(|energy| (SQUARED_RMS * energy).sqrt());
        Self {
            frequency_hz: texture.frequency_hz.clone(),
            level_db: texture.magnitude.iter().map(|m| decibels(*m)).collect(),
            band_db: rms.map(decibels).collect(),
        }
    }

    /// Returns the frequency (Hz) and level (dB) of the highest magnitude.
    #[must_use]
    pub fn peak(&self) -> (f64, f64) {
        let pairs = self.frequency_hz.iter().zip(&self.level_db);
        let highest = pairs.max_by(|a, b| a.1.total_cmp(b.1));
        highest.map_or((0.0, SILENCE_DB), |(hz, db)| (*hz, *db))
    }
}

fn decibels(value: f64) -> f64 {
    (20.0 * libm::log10(value)).max(SILENCE_DB)
}
