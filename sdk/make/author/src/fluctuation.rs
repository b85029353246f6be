//! How recordings and rendered textures fluctuate in time, and how much two fluctuations differ.

use htex_dsp::fluctuation::{EXCESS_BANDS, Fluctuation, envelope_excess};
use htex_format::Law;
use htex_host::{LoadedModel, Stream};
use schemars::JsonSchema;
use serde::Serialize;

use crate::segments::{SegmentChoice, choose_segments};
use crate::take::Take;
use crate::{AuthorError, Recording, SpectrumRef};
use htex_recording::Sums;

/// Length of the rendering that is measured, seconds.
const SECONDS: f64 = 20.0;
/// The seed is always the same, so that measuring again gives the same numbers.
const SEED: u64 = 1;
/// Samples rendered before the measured ones, seconds: a voice may begin softly.
const LEAD_S: f64 = 0.5;

/// Measures how a recording fluctuates; `None` if the recording is shorter than 3 s or silent.
pub fn fluctuation(recording: &Recording) -> Option<Fluctuation> {
    let axes: Vec<&[f64]> = recording.axes.iter().map(Vec::as_slice).collect();
    Fluctuation::new(&axes, recording.rate_hz)
}

/// Half the length of the moving average of speed and force by which a recording's level is
/// corrected, seconds. The law is about how the finger moves, not about how it trembles.
const HALF_AVERAGE_S: f64 = 0.1;
/// Largest correction of speed and force, as a ratio.
const MOST_RATIO: f64 = 10.0;
/// An excess counts if it is above this many standard errors, so that stationary noise gives 0.
const LEAST_ERRORS: f64 = 0.5;

/// Estimates the fluctuation of a texture from all its recordings: how strong one envelope that all
/// bands share must be for their envelopes to vary as much as in the recordings. `None` if nothing
/// exceeds stationary noise, or if no recording of at least 1 s is read in windows: the middles of
/// sweeps, 0.2 s each, are too short.
///
/// In each of four bands, the variance of the amplitude envelope that exceeds the one of stationary
/// noise is averaged over the recordings, by their lengths. Of the four averages, the second lowest
/// counts. What one band alone has more, the others do not share. On recorded sounds and strokes, the
/// median of the bands predicts the other half of a recording less well (modulation spectrum: 4.14
/// and 4.47 dB instead of 4.06 and 4.31), and so does what all third octaves share (4.80 and 4.40).
///
/// The formula takes the variance of the envelope for the variance of its part of the logarithm.
/// An exponential moves some of it to higher frequencies: noise that fluctuates by 4 dB slowly is
/// found to do so by 3.3 dB slowly and 1.7 dB fast. Undoing this predicted the other halves less
/// well (sounds: 4.19 instead of 4.06 dB).
///
/// Where speed or force were recorded, the level is divided by the texture's law first: a player
/// applies the law itself.
pub(crate) fn fluctuation_of_texture(
    takes: &[Take],
    segments: SegmentChoice,
    law: &Law,
) -> Option<htex_format::Fluctuation> {
    let mut bands = [Average::default(); EXCESS_BANDS];
    for take in takes {
        let recording = &take.recording;
        if choose_segments(recording, segments).from_sweeps {
            continue;
        }
        let correction = correction(recording, law);
        let axes = recording.axes.iter().filter_map(|axis| {
            let corrected = axis.iter().zip(&correction).map(|(x, factor)| x / factor);
            envelope_excess(&corrected.collect::<Vec<_>>(), recording.rate_hz)
        });
        let axes: Vec<_> = axes.collect();
        for (band, average) in bands.iter_mut().enumerate() {
            let found: Vec<_> = axes.iter().filter_map(|bands| bands[band]).collect();
            let power: f64 = found.iter().map(|axis| axis.power).sum();
            for axis in found {
                let weight = recording.duration_s() * axis.power / power;
                average.add(weight, axis.excess, axis.error);
            }
        }
    }
    let found: Vec<[f64; 2]> = bands.iter().filter_map(Average::excess).collect();
    let strength_db = [0, 1].map(|range| {
        let mut all: Vec<f64> = found.iter().map(|excess| excess[range]).collect();
        all.sort_by(f64::total_cmp);
        // The lower one of the two in the middle.
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

    /// The mean in each range, or 0 where it is within its error; `None` if nothing was added.
    fn excess(&self) -> Option<[f64; 2]> {
        let mean = |range: usize| {
            let least = LEAST_ERRORS * libm::sqrt(self.error[range]);
            if self.excess[range] > least { self.excess[range] / self.weight } else { 0.0 }
        };
        (self.weight > 0.0).then(|| [mean(0), mean(1)])
    }
}

/// The factor by which the law changes the level at each sample, relative to the mean motion. It is
/// 1 where speed and force were not recorded.
fn correction(recording: &Recording, law: &Law) -> Vec<f64> {
    let half = (HALF_AVERAGE_S * recording.rate_hz) as usize;
    let ratios = |signal: &Option<Vec<f64>>| {
        let sums = Sums::new(signal.iter().flatten().map(|x| x.abs()));
        let mean = sums.mean(0, sums.samples());
        (0..recording.samples()).map(move |at| {
            let ratio = if mean > 0.0 { sums.mean_around(at, half) / mean } else { 1.0 };
            ratio.clamp(1.0 / MOST_RATIO, MOST_RATIO)
        })
    };
    let motion = ratios(&recording.speed_mm_s).zip(ratios(&recording.normal_n));
    motion.map(|(speed, force)| law.level_factor(speed, force)).collect()
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
    let rate_hz = 4.0 * reference.band.high_hz;
    let lead = (LEAD_S * rate_hz) as usize;
    let mut samples = vec![0.0f32; lead + (SECONDS * rate_hz) as usize];
    Stream::new(model, parameters, reference.band, rate_hz, SEED)?.render(&mut samples)?;
    let samples: Vec<f64> = samples[lead..].iter().map(|x| f64::from(*x)).collect();
    Ok(Fluctuation::new(&[&samples], rate_hz))
}

/// How the fluctuation of a signal differs from the fluctuation of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
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
