//! A recording as sound: what is read of it, in the band, as a loop.
//!
//! Segments are windowed (Hann) and half overlap, so that those of one stretch add up to the signal that they were cut from. Where two of
//! them were cut from different stretches, one fades to the other, and the sum is raised to the power of a fade by equal power. The last
//! segment fades to the first one, so that the loop has no seam.

use htex_dsp::bands::rms;
use htex_dsp::grid::{Band, GRID_HZ};
use htex_format::Quantity;

use crate::level::recorded_level;
use crate::reading::read_take;
use crate::segments::Segments;
use crate::spectrum::overlap_add;
use crate::take::Take;
use crate::{AuthorError, Exploration, SpectrumOptions, TextureSpectrum};

/// Highest rate of a loop, hertz.
const MOST_RATE_HZ: f64 = 192_000.0;

/// What is read of a recording, as samples that are played again and again.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RecordedLoop {
    /// Speed and force: the given values, else the medians of the measured ones.
    pub condition: Exploration,
    /// The recorded quantity, which has the unit of the samples.
    pub quantity: Quantity,
    /// The samples, in the band of the spectrum alone; compensated and of one axis, as it is.
    pub samples: Vec<f64>,
    pub rate_hz: f64,
    /// RMS of the samples: the level of models that are fitted to the recording.
    pub level_rms: f64,
    /// Number of segments that are read.
    pub segments: usize,
}

impl RecordedLoop {
    /// Reads a recording and makes its loop at a rate.
    ///
    /// # Errors
    /// As [`read_take`], and for a rate that is no multiple of 10 Hz, that is not above twice the band's highest frequency, or above
    /// 192 kHz.
    pub fn of(
        take: &Take,
        options: &SpectrumOptions,
        strict: bool,
        rate_hz: f64,
    ) -> Result<Self, AuthorError> {
        let reading = read_take(take, options, strict)?;
        let part = &reading.part;
        let spectrum = TextureSpectrum::average(std::slice::from_ref(part), options.averaging)?;
        let len = frame_len(rate_hz, part.band)?;
        let all: Vec<_> = part.spectra.iter().map(Vec::as_slice).collect();
        let mut samples = around(overlap_add(part.band, &all, len), len / 2);
        raise_joins(&mut samples, &part.segments, len / 2);
        let level_rms = recorded_level(&spectrum.magnitude);
        set_level(&mut samples, level_rms);
        Ok(Self {
            condition: reading.condition,
            quantity: part.quantity,
            samples,
            rate_hz,
            level_rms,
            segments: part.spectra.len(),
        })
    }
}

/// Samples of a segment at a rate: an even number, since half of it is a step.
fn frame_len(rate_hz: f64, band: Band) -> Result<usize, AuthorError> {
    let len = rate_hz / GRID_HZ;
    let is_whole = len % 2.0 == 0.0 && rate_hz <= MOST_RATE_HZ;
    match is_whole && len > 2.0 * band.last_bin() as f64 {
        true => Ok(len as usize),
        false => Err(AuthorError::LoopRate {
            rate_hz,
            least_hz: 2.0 * GRID_HZ * band.last_bin() as f64,
            most_hz: MOST_RATE_HZ,
        }),
    }
}

/// Adds the end of the last segment to the beginning of the first one.
fn around(mut samples: Vec<f64>, half: usize) -> Vec<f64> {
    let end = samples.split_off(samples.len().saturating_sub(half));
    samples.iter_mut().zip(end).for_each(|(s, x)| *s += x);
    samples
}

/// Raises the power where a segment fades to one of another stretch: two signals that are not alike, weighted by a window and by
/// the rest to one.
fn raise_joins(samples: &mut [f64], segments: &Segments, half: usize) {
    let step = segments.len.div_ceil(2);
    let follows = |i: usize| {
        let before = i.checked_sub(1).and_then(|k| segments.starts.get(k));
        before.map(|start| start + step) == segments.starts.get(i).copied()
    };
    for (i, join) in samples.chunks_mut(half).enumerate() {
        if follows(i) {
            continue;
        }
        for (k, sample) in join.iter_mut().enumerate() {
            let turn = std::f64::consts::PI * k as f64 / half as f64;
            let rising = 0.5 - 0.5 * libm::cos(turn);
            *sample /= (rising * rising + (1.0 - rising) * (1.0 - rising)).sqrt();
        }
    }
}

fn set_level(samples: &mut [f64], level_rms: f64) {
    let own = rms(samples);
    if own > 0.0 {
        samples.iter_mut().for_each(|s| *s *= level_rms / own);
    }
}
