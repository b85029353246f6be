//! How recordings and rendered textures fluctuate in time, and how much two fluctuations differ.

use std::ops::Range;

use htex_dsp::Band;
use htex_dsp::fluctuation::{EXCESS_BANDS, Fluctuation, LEAST_S, envelope_excess};
use htex_dsp::random_envelope::RandomEnvelope;
use htex_format::Law;
use htex_host::{LoadedModel, Stream};
use serde::Serialize;

use crate::segments::{SegmentChoice, choose_segments};
use crate::take::Take;
use crate::{AuthorError, Recording, SpectrumRef};
use htex_recording::Sums;

/// Length of the rendering that is measured, seconds.
const SECONDS: f64 = 20.0;
/// The seed is always the same, so that measuring again gives the same numbers.
const SEED: u64 = 1;
/// Duration of the samples that are rendered before the measured samples, seconds. They are needed
/// because a voice may begin softly.
const LEAD_S: f64 = 0.5;

/// Measures how a recording fluctuates; `None` if the recording is shorter than 3 s or silent.
pub fn fluctuation(recording: &Recording) -> Option<Fluctuation> {
    let axes: Vec<&[f64]> = recording.axes.iter().map(Vec::as_slice).collect();
    Fluctuation::new(&axes, recording.rate_hz)
}

/// If the sample rate of a recording is below this fraction of the rendering's sample rate, the
/// recording has fewer third octaves.
const LOW_RATE: f64 = 0.53;

/// The level of a recording is corrected by a moving average of speed and force. This is half the
/// length of the average, seconds. The average is needed because the law describes how the finger
/// moves, and not how it trembles.
const HALF_AVERAGE_S: f64 = 0.1;
/// Largest correction of speed and force, as a ratio.
const MOST_RATIO: f64 = 10.0;
/// An excess counts only if it is above this many standard errors, so that stationary noise gives
/// 0.
const LEAST_ERRORS: f64 = 0.5;

/// Estimates the fluctuation of a texture from all its recordings. Suppose that all bands are
/// multiplied by the same envelope. The estimate is the strength of this envelope at which the
/// envelopes of the bands vary as much as in the recordings. `None` if nothing exceeds stationary
/// noise, or if no recording of at least 1 s is read in windows. The middles of sweeps are too
/// short, because they have only 0.2 s each.
///
/// In each of four bands, the function computes by how much the variance of the amplitude envelope
/// exceeds the variance for stationary noise. It averages this excess over the recordings, weighted
/// by their lengths. Of the four averages, it uses the second lowest, because the excess of a
/// single band is not shared by the other bands. We compared two alternatives on recorded sounds
/// and strokes. The errors of predicting the modulation spectrum of the other half of a recording
/// are 4.06 and 4.31 dB. With the median of the bands, they are 4.14 and 4.47 dB. With the part
/// that all third octaves share, they are 4.80 and 4.40 dB.
///
/// The formula computes the strength of each part of the logarithm from the variance of the
/// envelope in the same range of frequencies. But the exponential moves some of the variance to
/// higher frequencies. For example, the estimate for noise that fluctuates slowly by 4 dB is 3.3 dB
/// for the slow part and 1.7 dB for the fast part. We tried to correct this effect, but with the
/// correction the other halves were predicted less well (sounds: 4.19 instead of 4.06 dB).
///
/// If speed or force were recorded, the level is first divided by the texture's law, because a
/// player applies the law itself.
pub(crate) fn fluctuation_of_texture(
    takes: &[Take],
    segments: SegmentChoice,
    law: &Law,
) -> Option<htex_format::Fluctuation> {
    let recordings = read_in_windows(takes, segments);
    estimate(recordings.map(|recording| Corrected::new(recording, 0..recording.samples(), law)))
}

/// Returns the recordings from which windows are read, and not the middles of sweeps.
fn read_in_windows(
    takes: &[Take],
    segments: SegmentChoice,
) -> impl Iterator<Item = &Recording> + Clone {
    let recordings = takes.iter().map(|take| &take.recording);
    recordings.filter(move |recording| !choose_segments(recording, segments).from_sweeps)
}

/// Estimates one fluctuation from all parts together.
fn estimate(parts: impl Iterator<Item = Corrected>) -> Option<htex_format::Fluctuation> {
    let mut bands = [Average::default(); EXCESS_BANDS];
    for part in parts {
        let axes = part.axes.iter().filter_map(|axis| envelope_excess(axis, part.rate_hz));
        let axes: Vec<_> = axes.collect();
        for (band, average) in bands.iter_mut().enumerate() {
            let found: Vec<_> = axes.iter().filter_map(|bands| bands[band]).collect();
            let power: f64 = found.iter().map(|axis| axis.power).sum();
            for axis in found {
                let weight = part.duration_s() * axis.power / power;
                average.add(weight, axis.excess, axis.error);
            }
        }
    }
    let found: Vec<[f64; 2]> = bands.iter().filter_map(Average::excess).collect();
    let strength_db = [0, 1].map(|range| {
        let mut all: Vec<f64> = found.iter().map(|excess| excess[range]).collect();
        all.sort_by(f64::total_cmp);
        // Takes the lower one of the two middle values.
        let shared = all.get(all.len().saturating_sub(1) / 2).copied().unwrap_or_default();
        // The envelope exp(x) of Gaussian noise x has the relative variance exp(σ²) - 1.
        libm::sqrt(libm::log1p(shared)) * 20.0 / std::f64::consts::LN_10
    });
    htex_format::Fluctuation::from_db(strength_db)
}

/// The weighted mean of the excess of one band.
#[derive(Debug, Clone, Copy, Default)]
struct Average {
    weight: f64,
    excess: [f64; 2],
    error: [f64; 2],
}

impl Average {
    fn add(&mut self, weight: f64, excess: [f64; 2], error: [f64; 2]) {
        self.weight += weight;
        for range in 0..2 {
            self.excess[range] += weight * excess[range];
            self.error[range] += weight * weight * error[range];
        }
    }

    /// Returns the mean in each range of frequencies, or 0 if the mean is within its error. Returns
    /// `None` if nothing was added.
    fn excess(&self) -> Option<[f64; 2]> {
        let mean = |range: usize| {
            let least = LEAST_ERRORS * libm::sqrt(self.error[range]);
            if self.excess[range] > least { self.excess[range] / self.weight } else { 0.0 }
        };
        (self.weight > 0.0).then(|| [mean(0), mean(1)])
    }
}

/// A part of a recording, divided by the factor by which the law changes the level.
struct Corrected {
    axes: Vec<Vec<f64>>,
    rate_hz: f64,
}

impl Corrected {
    fn new(recording: &Recording, samples: Range<usize>, law: &Law) -> Self {
        let correction = correction(recording, samples.clone(), law);
        let axes = recording.axes.iter().map(|axis| {
            let part = axis[samples.clone()].iter();
            part.zip(&correction).map(|(x, factor)| x / factor).collect()
        });
        Self { axes: axes.collect(), rate_hz: recording.rate_hz }
    }

    fn samples(&self) -> usize {
        self.axes.first().map_or(0, Vec::len)
    }

    fn duration_s(&self) -> f64 {
        self.samples() as f64 / self.rate_hz
    }

    fn fluctuation(&self) -> Option<Fluctuation> {
        let axes: Vec<&[f64]> = self.axes.iter().map(Vec::as_slice).collect();
        Fluctuation::new(&axes, self.rate_hz)
    }
}

/// Returns, for each sample, the factor by which the law changes the level, relative to the mean
/// motion of the samples. The factor is 1 if speed and force were not recorded.
fn correction(recording: &Recording, samples: Range<usize>, law: &Law) -> Vec<f64> {
    let half = (HALF_AVERAGE_S * recording.rate_hz) as usize;
    let ratios = |signal: &Option<Vec<f64>>| {
        let part = signal.iter().flat_map(|signal| &signal[samples.clone()]);
        let sums = Sums::new(part.map(|x| x.abs()));
        let mean = sums.mean(0, sums.samples());
        (0..samples.len()).map(move |at| {
            let ratio = if mean > 0.0 { sums.mean_around(at, half) / mean } else { 1.0 };
            ratio.clamp(1.0 / MOST_RATIO, MOST_RATIO)
        })
    };
    let motion = ratios(&recording.speed_mm_s).zip(ratios(&recording.normal_n));
    motion.map(|(speed, force)| law.level_factor(speed, force)).collect()
}

/// The voice of a model with the parameters of one condition.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SteadyVoice<'a> {
    pub(crate) model: &'a LoadedModel,
    pub(crate) parameters: &'a [f64],
    pub(crate) band: Band,
}

impl SteadyVoice<'_> {
    /// Renders 20 s, multiplied by an envelope if a strength is given. Returns the samples, and
    /// their sample rate in hertz.
    fn render(self, strength_db: Option<[f64; 2]>) -> Result<(Vec<f64>, f64), AuthorError> {
        let rate_hz = 4.0 * self.band.high_hz;
        let lead = (LEAD_S * rate_hz) as usize;
        let mut samples = vec![0.0f32; lead + (SECONDS * rate_hz) as usize];
        let mut stream = Stream::new(self.model, self.parameters, self.band, rate_hz, SEED)?;
        stream.render(&mut samples)?;
        if let Some(strength_db) = strength_db {
            RandomEnvelope::new(strength_db, rate_hz, SEED).apply(&mut samples);
        }
        Ok((samples[lead..].iter().map(|x| f64::from(*x)).collect(), rate_hz))
    }
}

/// Measures how well the fluctuation of the first halves of recordings predicts the second halves.
///
/// The function estimates the fluctuation from all first halves together, and renders 20 s of noise
/// with this fluctuation. It cuts the noise into parts that are as long as the second half of the
/// recording, because the modulation spectrum of a short signal is less certain. For each part, it
/// compares the modulation spectrum with that of the second half. `held_out_error_db` is the mean
/// of these differences. `halves_error_db` is the difference between the two halves of the
/// recording. Both are averaged over the recordings by their lengths.
///
/// If a recording of at least 6 s is read in windows, returns the fluctuation with these errors.
/// Only the estimate of the fluctuation leaves out the second halves. The model was fitted to the
/// whole recordings, but this has hardly any effect: in a modulation spectrum, every third octave
/// is divided by its mean, so it hardly depends on the spectrum.
///
/// # Errors
/// When the model cannot render.
pub(crate) fn with_held_out_error(
    fluctuation: htex_format::Fluctuation,
    takes: &[Take],
    segments: SegmentChoice,
    law: &Law,
    voice: SteadyVoice<'_>,
) -> Result<htex_format::Fluctuation, AuthorError> {
    let recordings: Vec<&Recording> = read_in_windows(takes, segments)
        .filter(|recording| recording.duration_s() >= 2.0 * LEAST_S)
        .collect();
    if recordings.is_empty() {
        return Ok(fluctuation);
    }
    let half = |recording: &Recording, number: usize| {
        let middle = recording.samples() / 2;
        Corrected::new(recording, number * middle..(number + 1) * middle, law)
    };
    let estimated = estimate(recordings.iter().map(|recording| half(recording, 0)));
    let strength_db = estimated.map(htex_format::Fluctuation::decibels);
    let (samples, rate_hz) = voice.render(strength_db)?;
    let (mut weights, mut sums) = (0.0, [0.0; 2]);
    for recording in recordings {
        let second = half(recording, 1);
        let halves = half(recording, 0).fluctuation().zip(second.fluctuation());
        let Some((before, after)) = halves else { continue };
        let Some(played_db) = error_of_parts(&after, &second, &samples, rate_hz) else { continue };
        let weight = recording.duration_s();
        weights += weight;
        sums[0] += weight * played_db;
        sums[1] += weight * before.error_rms_db(&after);
    }
    let mean = |sum: f64| (sum / weights).min(htex_format::Fluctuation::MOST_ERROR_DB);
    let [held_out_error_db, halves_error_db] = sums.map(|sum| (weights > 0.0).then(|| mean(sum)));
    Ok(htex_format::Fluctuation { held_out_error_db, halves_error_db, ..fluctuation })
}

/// Compares the modulation spectrum of a recording with the modulation spectra of parts of a
/// rendering, and returns the mean difference. The parts are as long as the recording. Returns
/// `None` if a part cannot be measured.
fn error_of_parts(
    recorded: &Fluctuation,
    recording: &Corrected,
    samples: &[f64],
    rate_hz: f64,
) -> Option<f64> {
    // The third octaves end at 0.95 of half the sample rate. If the recording has a low sample
    // rate, the rendering has about twice this rate. In this case only every second sample of the
    // rendering is used, so that the third octaves of both end at the same frequency.
    let every = if recording.rate_hz < LOW_RATE * rate_hz { 2 } else { 1 };
    let samples: Vec<f64> = samples.iter().copied().step_by(every).collect();
    let rate_hz = rate_hz / every as f64;
    let part = libm::ceil(recording.duration_s() * rate_hz) as usize;
    let parts = samples.chunks_exact(part.clamp(1, samples.len()));
    let measured = parts.map(|part| Fluctuation::new(&[part], rate_hz));
    let measured = measured.collect::<Option<Vec<Fluctuation>>>()?;
    let sum: f64 = measured.iter().map(|part| recorded.error_rms_db(part)).sum();
    Some(sum / measured.len() as f64)
}

/// Measures how the voice of a model fluctuates with the given parameters.
///
/// # Errors
/// When the model cannot render.
pub(crate) fn voice_fluctuation(
    model: &LoadedModel,
    parameters: &[f64],
    reference: SpectrumRef<'_>,
) -> Result<Option<Fluctuation>, AuthorError> {
    let (samples, rate_hz) =
        SteadyVoice { model, parameters, band: reference.band }.render(None)?;
    Ok(Fluctuation::new(&[&samples], rate_hz))
}

/// The difference between the fluctuation of a signal and the fluctuation of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct FluctuationDifference {
    /// RMS difference of the modulation spectra, decibels. If a surface is recorded twice, this
    /// difference is at most the second value of [`SECOND_TAKES_DB`] in 95 % of cases.
    pub fluctuation_error_db: f64,
    /// Kurtosis of the recording and of the other signal; 3 for Gaussian noise.
    pub kurtosis: [f64; 2],
    /// Mean correlation between the envelopes of wide bands: first in the recording, then in the
    /// other signal. `None` if the band of the signal is too narrow.
    pub envelope_correlation: [Option<f64>; 2],
}

/// Limits for two differences between takes, in decibels: the difference in third octaves, and the
/// difference in the modulation spectrum. Of 148 pairs of takes, 95 % stay within these limits. In
/// each pair, both takes are recordings of a robot's fingertip on the same surface, 3 s each.
pub const SECOND_TAKES_DB: [f64; 2] = [2.0, 3.4];

impl FluctuationDifference {
    /// Compares a signal with a recording.
    pub fn new(recorded: &Fluctuation, other: &Fluctuation) -> Self {
        Self {
            fluctuation_error_db: recorded.error_rms_db(other),
            kurtosis: [recorded, other].map(|signal| signal.kurtosis),
            envelope_correlation: [recorded, other].map(|signal| signal.envelope_correlation),
        }
    }
}
