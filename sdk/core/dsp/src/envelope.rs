//! Measures a stream of samples: its level, its mean frequency, and its power in bands.
//!
//! The level is the exact RMS of the samples of a block, and has no delay. Mean frequency and bands
//! are computed from periodic Hann windows of `N` samples, where `N` is the smallest power of two
//! that lasts at least 40 ms. At 20 kHz, `N` is 1024 (51.2 ms), and at 48 kHz, `N` is 2048 (42.7
//! ms). One window ends every `N / 4` samples. Before the first sample, the stream counts as 0.
//!
//! Let `X[k]` be the transform of the windowed samples, and `W` the sum of the squared window. Bin
//! `k`, at `k * rate / N`, has the power `|X[k]|² / (N * W)`. All bins except the first and the
//! last count twice. The powers of all bins then add up to the mean square of the windowed samples,
//! divided by the mean square of the window. The result for a block is the mean over the windows
//! that end in the block. If no window ends in the block, the result of the previous block is
//! repeated.

use alloc::vec::Vec;

use num_complex::Complex;

use crate::fft::RealFft;
use crate::grid::Band;
use crate::window::hann_periodic;

/// Shortest window, seconds: two periods of 50 Hz, and nearly one of 20 Hz, which is the lowest
/// frequency of a texture.
const WINDOW_S: f64 = 0.040;
/// Number of windows that overlap at each sample.
const OVERLAP: usize = 4;

/// Measurements of a stream since the last call of [`Analyser::read`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// RMS of the samples; 0 if there are none.
    pub level_rms: f64,
    /// Mean frequency, hertz: the mean of the frequencies, weighted by their power. The mean
    /// frequency is 0 for silence.
    pub centroid_hz: f64,
    /// Number of samples.
    pub frames: u64,
}

/// Sums over windows or samples.
#[derive(Debug, Clone, Default)]
struct Sums {
    squares: f64,
    frames: u64,
    windows: u64,
    power: f64,
    /// Power times frequency.
    moment: f64,
}

/// Measures the level, mean frequency and band powers of a stream of samples.
///
/// ```
/// use htex_dsp::envelope::Analyser;
/// use htex_dsp::grid::Band;
/// let mut analyser = Analyser::new(3, Band::TACTILE, 20_000.0);
/// let sine = |n: i32| (core::f32::consts::TAU * 250.0 * n as f32 / 20_000.0).sin();
/// analyser.push(&(0..8_000).map(sine).collect::<Vec<_>>());
/// let mut bands = [0.0; 3];
/// let measured = analyser.read(&mut bands);
/// assert!((measured.level_rms - 0.5f64.sqrt()).abs() < 1e-3);
/// assert!((measured.centroid_hz - 250.0).abs() < 1.0);
/// assert!(bands[1] > 100.0 * bands[0]); // 74 to 271 Hz
/// ```
#[derive(Debug, Clone)]
pub struct Analyser {
    rate_hz: f64,
    edges_hz: Vec<f64>,
    /// Index of the band that each bin belongs to.
    band_of: Vec<usize>,
    window: Vec<f64>,
    /// Factor from the squared magnitude of a bin to its power.
    scale: f64,
    fft: RealFft,
    bins: Vec<Complex<f64>>,
    windowed: Vec<f64>,
    /// The last samples; the oldest one is at index `at`.
    ring: Vec<f32>,
    at: usize,
    /// Number of samples since the last nonzero sample.
    quiet: usize,
    sums: Sums,
    /// Sums over the windows that ended since the last call of [`Self::read`]. After such a call,
    /// this field contains the values of the last window.
    bands: Vec<f64>,
    centroid_hz: f64,
}

impl Analyser {
    /// Makes an analyser with `count` bands (at least one). The bands divide `band` so that the
    /// ratio of upper to lower edge is the same for all bands.
    pub fn new(count: usize, band: Band, rate_hz: f64) -> Self {
        let count = count.max(1);
        let len = libm::ceil(WINDOW_S * rate_hz) as usize;
        let len = len.next_power_of_two().max(OVERLAP);
        let ratio = band.high_hz / band.low_hz;
        let edge = |k: usize| band.low_hz * libm::pow(ratio, k as f64 / count as f64);
        let edges_hz: Vec<f64> = (0..=count).map(edge).collect();
        let fft = RealFft::new(len);
        let bins = fft.make_bins();
        // Bins below the second edge belong to the first band; bins above the last edge but one
        // belong to the last band.
        let inner = &edges_hz[1..count];
        let band_at = |hz: f64| inner.partition_point(|edge| *edge <= hz);
        let window = hann_periodic(len);
        let squares: f64 = window.iter().map(|w| w * w).sum();
        Self {
            rate_hz,
            band_of: (0..bins.len()).map(|k| band_at(k as f64 * rate_hz / len as f64)).collect(),
            scale: 1.0 / (len as f64 * squares),
            window,
            fft,
            bins,
            windowed: alloc::vec![0.0; len],
            ring: alloc::vec![0.0; len],
            at: 0,
            // The samples before the first one count as zeros.
            quiet: len,
            sums: Sums::default(),
            bands: alloc::vec![0.0; edges_hz.len() - 1],
            centroid_hz: 0.0,
            edges_hz,
        }
    }

    /// Returns the number of bands.
    pub fn bands(&self) -> usize {
        self.bands.len()
    }

    /// Returns the edges of the bands, ascending, hertz; there is one more edge than bands. The
    /// list starts and ends with the edges of `band`. Nevertheless, the first band also contains
    /// all lower frequencies, down to 0 Hz, and the last band also contains all higher frequencies,
    /// up to half the rate.
    pub fn edges_hz(&self) -> &[f64] {
        &self.edges_hz
    }

    /// Adds the next samples of the stream.
    pub fn push(&mut self, samples: &[f32]) {
        let mut rest = samples;
        while !rest.is_empty() {
            // `now` goes at most to the end of a window, because `advance` must not go beyond the
            // end of a window.
            let (now, later) = rest.split_at(self.to_window().min(rest.len()));
            self.ring[self.at..self.at + now.len()].copy_from_slice(now);
            self.sums.squares += now.iter().map(|x| f64::from(x * x)).sum::<f64>();
            self.quiet = match now.iter().rposition(|x| *x != 0.0) {
                Some(last) => now.len() - 1 - last,
                None => self.quiet.saturating_add(now.len()),
            };
            self.advance(now.len());
            rest = later;
        }
    }

    /// Adds `count` samples that are 0.
    pub fn push_zeros(&mut self, mut count: usize) {
        const ZEROS: [f32; 64] = [0.0; 64];
        while count > 0 && self.quiet < self.ring.len() {
            let now = count.min(ZEROS.len());
            self.push(&ZEROS[..now]);
            count -= now;
        }
        // All windows that end in the remaining samples are silent.
        let hop = self.hop();
        let ended = (self.at % hop + count) / hop;
        if ended > 0 {
            self.begin_window();
            self.sums.windows += ended as u64;
        }
        self.at = (self.at + count) % self.ring.len();
        self.sums.frames += count as u64;
    }

    fn hop(&self) -> usize {
        self.ring.len() / OVERLAP
    }

    /// Number of samples until the next window ends.
    fn to_window(&self) -> usize {
        self.hop() - self.at % self.hop()
    }

    /// Advances by `count` samples, which must not go beyond the end of the next window.
    fn advance(&mut self, count: usize) {
        self.sums.frames += count as u64;
        self.at += count;
        if self.at.is_multiple_of(self.hop()) {
            self.at %= self.ring.len();
            self.add_window();
        }
    }

    /// Drops the values of the last window when a new one ends.
    fn begin_window(&mut self) {
        if self.sums.windows == 0 {
            self.bands.fill(0.0);
        }
    }

    /// Adds the powers of the window that ends at this sample.
    fn add_window(&mut self) {
        self.begin_window();
        self.sums.windows += 1;
        // A silent window has no power, so its transform is saved.
        if self.quiet >= self.ring.len() {
            return;
        }
        let (new, old) = self.ring.split_at(self.at);
        for ((to, x), w) in self.windowed.iter_mut().zip(old.iter().chain(new)).zip(&self.window) {
            *to = f64::from(*x) * w;
        }
        self.fft.forward(&self.windowed, &mut self.bins);
        let last = self.bins.len() - 1;
        let step_hz = self.rate_hz / self.ring.len() as f64;
        for (k, (bin, band)) in self.bins.iter().zip(&self.band_of).enumerate() {
            // These two bins have no counterpart at a negative frequency.
            let sides = if k == 0 || k == last { 1.0 } else { 2.0 };
            let power = sides * self.scale * bin.norm_sqr();
            self.bands[*band] += power;
            self.sums.power += power;
            self.sums.moment += power * step_hz * k as f64;
        }
    }

    /// Returns the measurements since the last call, and writes the mean square of each band to
    /// `bands`. If `bands` is too short, the remaining bands are left out.
    pub fn read(&mut self, bands: &mut [f64]) -> Measurement {
        let sums = core::mem::take(&mut self.sums);
        if sums.windows > 0 {
            self.bands.iter_mut().for_each(|power| *power /= sums.windows as f64);
            self.centroid_hz = if sums.power > 0.0 { sums.moment / sums.power } else { 0.0 };
        }
        for (to, power) in bands.iter_mut().zip(&self.bands) {
            *to = *power;
        }
        let level_rms = match sums.frames {
            0 => 0.0,
            frames => libm::sqrt(sums.squares / frames as f64),
        };
        Measurement { level_rms, centroid_hz: self.centroid_hz, frames: sums.frames }
    }
}
