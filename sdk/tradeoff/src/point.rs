//! Measurements of one setting on one recording.

use std::collections::BTreeMap;

use htex_author::LosslessShare;
use htex_format::ErrorMeasure;
use serde::Serialize;
use serde_json::Value;

use crate::Setting;
use crate::contender::{Contender, ContenderKind};
use crate::measured::Measured;
use crate::timing::Timed;

/// Name of the first baseline, in place of a model's: the spectrum, one byte per bin.
pub const QUANTISED: &str = "quantised-spectrum";
/// Name of the second baseline: the recording.
pub const RECORDING: &str = "recording";

/// Cost and accuracy of one setting on one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// The recording.
    pub recording: String,
    /// Short name of the model, [`QUANTISED`] or [`RECORDING`].
    pub model: String,
    /// All knobs, including those at their defaults.
    pub knobs: BTreeMap<String, Value>,
    /// The knobs that are not at their defaults, as text.
    pub setting: String,
    /// The setting.
    #[serde(skip)]
    pub how: Setting,
    /// Median time of a fit, ms.
    pub fit_ms: f64,
    /// Half the interquartile range of the fit times over their median.
    pub fit_spread: f64,
    /// Median time from stored parameters to the first sample, microseconds.
    pub first_sample_us: f64,
    /// Half the interquartile range of the times to the first sample over their median.
    pub first_sample_spread: f64,
    /// Median time per output sample, ns.
    pub ns_per_sample: f64,
    /// Half the interquartile range of the times per sample over their median.
    pub spread: f64,
    /// Bytes of the stored parameters; for the recording, of its single-precision samples.
    pub bytes: usize,
    /// Bytes of a loop or a filter that are kept while playing.
    pub kept_bytes: usize,
    /// Spectral correlation of the model's magnitudes.
    pub spectral_correlation: f64,
    /// RMS error over the nine bands of the model's magnitudes, dB.
    pub band_error_rms_db: f64,
    /// RMS error over third-octave bands of the model's magnitudes, dB.
    pub third_octave_error_rms_db: f64,
    /// Log-spectral distance of the model's magnitudes: RMS over the bins of their difference in decibels.
    pub log_spectral_distance_db: f64,
    /// Level of the model's magnitudes relative to the recording's, dB.
    pub level_error_db: f64,
    /// RMS over third-octave bands of the difference of what is above a fingertip's detection threshold, of the model's magnitudes, dB.
    pub felt_error_rms_db: f64,
    /// Share of the recordings whose difference from the model's magnitudes is below the difference threshold in every band; 0 or 1 for one recording.
    pub share_below_difference_threshold: f64,
    /// Share of the recordings for which that holds, or whose nine-band error is at or below the recording's own repeatability.
    pub share_lossless: f64,
    /// Spectral correlation of rendered samples.
    pub samples_spectral_correlation: f64,
    /// RMS error over the nine bands of rendered samples, dB.
    pub samples_band_error_rms_db: f64,
    /// Half the range of that error over single renderings, dB.
    pub samples_band_error_spread_db: f64,
    /// RMS error over third-octave bands of rendered samples, dB.
    pub samples_third_octave_error_rms_db: f64,
    /// Log-spectral distance of rendered samples, dB.
    pub samples_log_spectral_distance_db: f64,
    /// Level of rendered samples relative to the recording's, dB.
    pub samples_level_error_db: f64,
    /// RMS over third-octave bands of the difference of what is above a fingertip's detection threshold, of rendered samples, dB.
    pub samples_felt_error_rms_db: f64,
    /// Whether it is on the front of bytes and magnitude error, among settings that play
    /// at their defaults.
    pub on_front: bool,
    /// Whether it is on the front of time and sample error, among settings with blocks and output rate at their
    /// defaults.
    pub on_time_front: bool,
}

impl Point {
    pub(crate) fn new(
        recording: &str,
        one: &Contender,
        measured: &Measured,
        timed: &Timed,
    ) -> Self {
        let descriptor = match &one.kind {
            ContenderKind::Model(model, _) => Some(model.descriptor()),
            _ => None,
        };
        let (magnitude, samples) = (measured.by_magnitude, measured.by_samples);
        let mut lossless = LosslessShare::default();
        lossless.count(&magnitude.felt);
        Self {
            recording: recording.to_owned(),
            model: one.model.clone(),
            knobs: one.setting.knobs(descriptor),
            setting: one.setting.words(),
            how: one.setting.clone(),
            fit_ms: timed.fit_ms.median,
            fit_spread: timed.fit_ms.spread,
            first_sample_us: timed.first_sample_us.median,
            first_sample_spread: timed.first_sample_us.spread,
            ns_per_sample: timed.ns_per_sample.median,
            spread: timed.ns_per_sample.spread,
            bytes: measured.bytes,
            kept_bytes: measured.kept_bytes,
            spectral_correlation: magnitude.spectral_correlation,
            band_error_rms_db: magnitude.band_error_rms_db,
            third_octave_error_rms_db: magnitude.third_octave_error_rms_db,
            log_spectral_distance_db: magnitude.log_spectral_distance_db,
            level_error_db: magnitude.level_error_db,
            felt_error_rms_db: magnitude.felt.error_rms_db,
            share_below_difference_threshold: lossless.below_difference_threshold as f64,
            share_lossless: lossless.either as f64,
            samples_spectral_correlation: samples.spectral_correlation,
            samples_band_error_rms_db: samples.band_error_rms_db,
            samples_band_error_spread_db: measured.samples_spread_db,
            samples_third_octave_error_rms_db: samples.third_octave_error_rms_db,
            samples_log_spectral_distance_db: samples.log_spectral_distance_db,
            samples_level_error_db: samples.level_error_db,
            samples_felt_error_rms_db: samples.felt.error_rms_db,
            on_front: false,
            on_time_front: false,
        }
    }

    /// Returns the error of the model's magnitudes, dB.
    pub fn error_db(&self, measure: ErrorMeasure) -> f64 {
        match measure {
            ErrorMeasure::NineBand => self.band_error_rms_db,
            ErrorMeasure::ThirdOctave => self.third_octave_error_rms_db,
            ErrorMeasure::LogSpectral => self.log_spectral_distance_db,
        }
    }

    /// Returns the error of rendered samples, dB.
    pub fn samples_error_db(&self, measure: ErrorMeasure) -> f64 {
        match measure {
            ErrorMeasure::NineBand => self.samples_band_error_rms_db,
            ErrorMeasure::ThirdOctave => self.samples_third_octave_error_rms_db,
            ErrorMeasure::LogSpectral => self.samples_log_spectral_distance_db,
        }
    }

    /// Returns model and setting.
    pub fn name(&self) -> String {
        format!("{} {}", self.model, self.setting)
    }

    /// Whether it is a baseline.
    pub fn is_baseline(&self) -> bool {
        self.model == QUANTISED || self.model == RECORDING
    }
}
