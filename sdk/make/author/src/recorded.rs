//! Playback of a recording: its segments are limited to the band and joined into a loop.
//!
//! The segments of a spectrum are windowed (Hann) and overlap by half. Removing the frequencies
//! outside the band makes the ends of a segment nonzero. A plain sum of the segments would then
//! have a step every 0.1 s. Therefore each segment is multiplied by the window once more before it
//! is added. Dividing the sum by the sum of the squared windows gives back the recorded signal.
//! Segments from different stretches of the recording have no signal in common. At a transition
//! between two such segments, the sum is divided by the square root of the sum of the windows'
//! fourth powers. This preserves the power. The last segment fades into the first segment in the
//! same way, so that the loop has no seam.

use htex_dsp::bands::rms;
use htex_dsp::grid::{Band, GRID_HZ};
use htex_format::Quantity;

use crate::level::recorded_level;
use crate::segments::Segments;
use crate::spectrum::each_frame;
use crate::take::{Take, segment_take};
use crate::{AuthorError, Exploration, SegmentSpectra, SpectrumOptions, TextureSpectrum};

/// Highest sample rate of a loop, hertz.
const MOST_RATE_HZ: f64 = 192_000.0;
/// Largest number of segments in a loop: 30 s.
const MOST_SEGMENTS: usize = 300;

/// A recording as a loop of samples that can be played again and again.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RecordedLoop {
    /// Speed and force of the recording: the given values or, if none are given, the medians of the
    /// measured values.
    pub condition: Exploration,
    /// The recorded quantity; the samples are in its unit.
    pub quantity: Quantity,
    /// The samples in the band of the spectrum, compensated for the setup's response. For a
    /// recording of one axis, the samples are the recorded signal in the band.
    pub samples: Vec<f64>,
    pub rate_hz: f64,
    /// RMS of the samples. By default, models that are fitted to the recording are stored with the
    /// same level.
    pub level_rms: f64,
    /// Number of segments in the loop. The loop contains at most the first 30 s of the segments
    /// that are read.
    pub segments: usize,
}

impl RecordedLoop {
    /// Reads a recording and makes its loop at a sample rate.
    ///
    /// # Errors
    /// Returns the errors of [`segment_take`]. Also returns an error if the rate is not a multiple
    /// of 10 Hz, is not above twice the band's highest frequency, or is above 192 kHz.
    pub fn new(
        take: &Take,
        options: &SpectrumOptions,
        strict: bool,
        rate_hz: f64,
    ) -> Result<Self, AuthorError> {
        let read = segment_take(take, options, strict)?;
        let part = &read.spectra;
        let spectrum = TextureSpectrum::average(std::slice::from_ref(part), options.averaging)?;
        let len = frame_len(rate_hz, part.band)?;
        let mut samples = joined(part, len);
        // The level of all segments, because models also have this level. The loop may contain only
        // the first 30 s of the segments.
        let level_rms = recorded_level(&spectrum.magnitude);
        set_level(&mut samples, level_rms);
        Ok(Self {
            condition: read.motion,
            quantity: part.quantity,
            segments: samples.len() / (len / 2),
            samples,
            rate_hz,
            level_rms,
        })
    }
}

/// Number of samples of a segment at a rate: an even number, since segments begin half a segment
/// apart.
fn frame_len(rate_hz: f64, band: Band) -> Result<usize, AuthorError> {
    let len = rate_hz / GRID_HZ;
    // The remainder of an infinite or undefined rate is not a number, so the comparison also
    // refuses such a rate.
    let is_whole = len % 2.0 == 0.0 && rate_hz <= MOST_RATE_HZ;
    if is_whole && len > 2.0 * band.last_bin() as f64 {
        Ok(len as usize)
    } else {
        Err(AuthorError::LoopRate {
            rate_hz,
            least_hz: 2.0 * GRID_HZ * band.last_bin() as f64,
            most_hz: MOST_RATE_HZ,
        })
    }
}

/// Adds the segments, of `len` samples each, around the loop. The segments begin half a segment
/// apart.
fn joined(part: &SegmentSpectra, len: usize) -> Vec<f64> {
    let half = len / 2;
    let spectra = part.spectra.iter().take(MOST_SEGMENTS);
    let all: Vec<_> = spectra.map(Vec::as_slice).collect();
    let window: Vec<f64> = (0..len).map(|k| hann(k, len)).collect();
    let (first, last) = window.split_at(half);
    let mut samples = vec![0.0; all.len() * half];
    each_frame(part.band, &all, len, |i, frame| {
        let (rising, falling) = frame.split_at(half);
        add(&mut samples, i * half, rising, first);
        add(&mut samples, (i + 1) % all.len() * half, falling, last);
    });
    for (i, join) in samples.chunks_mut(half).enumerate() {
        let of = if follows(&part.segments, i) { square_sum } else { power_sum };
        let weights = first.iter().zip(last).map(|(a, b)| of(*a, *b));
        join.iter_mut().zip(weights).for_each(|(s, w)| *s /= w);
    }
    samples
}

/// The window of a segment.
fn hann(k: usize, len: usize) -> f64 {
    0.5 - 0.5 * libm::cos(std::f64::consts::TAU * k as f64 / len as f64)
}

/// Multiplies half a segment by the window, and adds the products to the samples, starting at a
/// sample.
fn add(samples: &mut [f64], at: usize, half: &[f64], window: &[f64]) {
    let windowed = half.iter().zip(window).map(|(x, w)| x * w);
    let place = samples.iter_mut().skip(at);
    place.zip(windowed).for_each(|(s, x)| *s += x);
}

/// Whether a segment overlaps the one before it, so that both contain the same signal there.
fn follows(segments: &Segments, i: usize) -> bool {
    // The distance between windows in `segments.rs`. At any other distance, the two halves do not
    // contain the same part of the signal.
    let step = segments.len.div_ceil(2);
    let before = i.checked_sub(1).and_then(|k| segments.starts.get(k));
    before.is_some_and(|start| segments.starts.get(i) == Some(&(start + step)))
}

fn square_sum(a: f64, b: f64) -> f64 {
    a * a + b * b
}

fn power_sum(a: f64, b: f64) -> f64 {
    // Each segment is multiplied by two windows: its own and this one. Its power is therefore
    // multiplied by the squares of both windows.
    (a * a * a * a + b * b * b * b).sqrt()
}

fn set_level(samples: &mut [f64], level_rms: f64) {
    let own = rms(samples);
    if own > 0.0 {
        samples.iter_mut().for_each(|s| *s *= level_rms / own);
    }
}
