//! Spectra of windows in which the finger covers equal lengths of path.
//!
//! Most of a texture's spectrum comes from the relief of the surface. The frequencies that the
//! relief produces are proportional to the finger's speed. In a window, the finger may be faster or
//! slower than the speed of the window's grid line. In this case, the module changes the length of
//! the window. In the changed window, the finger covers the same path as it covers in 0.2 s at the
//! line's speed. The frequency bins of the changed window correspond to the frequencies that the
//! relief produces at the line's speed (order tracking, as for rotating machines). With changed
//! lengths, the spectral lines of a weave remain sharp although the speed varies within a cell. In
//! exchange, components that do not follow the speed are blurred by the same amount.

use std::collections::BTreeMap;
use std::ops::Range;

use htex_dsp::Band;
use htex_dsp::spectrum::Complex;

use crate::blocks::Span;
use crate::spectrum::{SegmentReader, Trend, inverse_at};
use crate::{AuthorError, SetupResponse, Take};

/// The length of a window is adapted only up to this ratio between the window's speed and the
/// line's speed.
pub(super) const MOST: f64 = 1.5;
/// Window lengths are multiples of a step, which is 0.2 s divided by this number. This limits the
/// number of different lengths, because each length needs its own tables.
const STEPS: f64 = 100.0;

/// A steady window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// Index of its recording.
    pub(super) take: usize,
    /// First sample of its 0.2 s.
    pub(super) start: usize,
    /// Number of samples in 0.2 s.
    pub(super) len: usize,
    /// Logarithms of the mean speed in mm/s and the mean force in N.
    pub(super) motion: [f64; 2],
}

/// A reader of the windows of some recordings.
pub(super) struct Paths<'a> {
    takes: &'a [Take],
    response: Option<&'a SetupResponse>,
    band: Band,
    readers: BTreeMap<usize, SegmentReader>,
    inverses: BTreeMap<[usize; 2], Vec<Complex<f64>>>,
}

impl<'a> Paths<'a> {
    pub(super) fn new(takes: &'a [Take], response: Option<&'a SetupResponse>, band: Band) -> Self {
        Self { takes, response, band, readers: BTreeMap::new(), inverses: BTreeMap::new() }
    }

    /// Returns the spectrum of a window on the band's grid. The window is read over the path that a
    /// finger covers in 0.2 s at the speed with the given logarithm.
    pub(super) fn read(
        &mut self,
        window: &Window,
        log_speed: f64,
    ) -> Result<Vec<Complex<f64>>, AuthorError> {
        let recording = &self.takes[window.take].recording;
        let samples = self.samples(window, log_speed);
        let (start, len) = (samples.start, samples.len());
        let band = self.band;
        let reader =
            self.readers.entry(len).or_insert_with(|| SegmentReader::new(len, band, Trend::Linear));
        let mut bins = reader.read(&recording.axes, start)?;
        if let Some(response) = self.response {
            // The bins are numbered by the frequencies at the line's speed. But the response of the
            // setup applies to the frequencies at the finger's actual speed.
            let faster = window.len as f64 / len as f64;
            let inverse = self.inverses.entry([window.len, len]).or_insert_with(|| {
                let frequency_hz = band.grid_hz().into_iter().map(|f| f * faster);
                inverse_at(response, band, frequency_hz)
            });
            bins.iter_mut().zip(inverse).for_each(|(bin, h)| *bin *= *h);
        }
        Ok(bins)
    }

    /// Returns the range of samples, around the middle of a window, in which the finger covers the
    /// same path as in 0.2 s at the speed with the given logarithm.
    pub(super) fn samples(&self, window: &Window, log_speed: f64) -> Range<usize> {
        let len = self.length(window, log_speed);
        let middle = window.start + window.len / 2;
        let samples = self.takes[window.take].recording.samples();
        let start = middle.saturating_sub(len / 2).min(samples.saturating_sub(len));
        start..start + len
    }

    /// Returns the range of the samples that are read for a window, in segments of 0.2 s.
    pub(super) fn span(&self, window: &Window, log_speed: f64) -> Span {
        let samples = self.samples(window, log_speed);
        let place = |sample: usize| sample as f64 / window.len as f64;
        Span { take: window.take, from: place(samples.start), to: place(samples.end) }
    }

    /// Returns the number of samples in which the finger covers the path of 0.2 s at the given
    /// speed. If the spectrum of this path would not reach the end of the band, or the recording is
    /// too short for it, returns the number of samples in 0.2 s.
    fn length(&self, window: &Window, log_speed: f64) -> usize {
        let most = libm::log(MOST);
        let ratio = libm::exp((log_speed - window.motion[0]).clamp(-most, most));
        // The step is even. Therefore, all lengths are even if the window's own length is even.
        let step = libm::round(window.len as f64 / (2.0 * STEPS)).max(1.0) * 2.0;
        let len = (libm::round(window.len as f64 * ratio / step) * step) as usize;
        let samples = self.takes[window.take].recording.samples();
        // The last bin of a Fourier transform of this length has the number `len / 2`.
        if len / 2 >= self.band.last_bin() && len <= samples { len } else { window.len }
    }
}
