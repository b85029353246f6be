//! One measured setting on one recording.

use std::collections::BTreeMap;

use htex_format::ErrorMeasure;
use serde::Serialize;
use serde_json::Value;

use crate::Setting;
use crate::contender::{Contender, Kind};
use crate::measured::Measured;
use crate::timing::Timed;

/// Name of the first baseline in place of a model's: the spectrum, a byte a bin.
pub const QUANTISED: &str = "quantised-spectrum";
/// Name of the second: the recording itself.
pub const RECORDING: &str = "recording";

/// One setting on one recording: what it costs, and how near it comes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// The recording.
    pub recording: String,
    /// Short name of the model, [`QUANTISED`] or [`RECORDING`].
    pub model: String,
    /// All knobs, those at their defaults too.
    pub knobs: BTreeMap<String, Value>,
    /// The knobs that are not at their defaults, in words.
    pub setting: String,
    /// The setting.
    #[serde(skip)]
    pub how: Setting,
    /// Time of a fit, ms: the median.
    pub fit_ms: f64,
    /// Half the distance between the quartiles over the median, of the fit.
    pub fit_spread: f64,
    /// From stored parameters to the first sample, microseconds: the median.
    pub first_sample_us: f64,
    /// Half the distance between the quartiles over the median, of the first sample.
    pub first_sample_spread: f64,
    /// Time of an output sample, ns: the median.
    pub ns_per_sample: f64,
    /// Half the distance between the quartiles over the median, of a sample.
    pub spread: f64,
    /// Bytes of the stored parameters; of the recording as single-precision numbers.
    pub bytes: usize,
    /// Bytes of a loop or a filter that are kept while it plays.
    pub kept_bytes: usize,
    /// Correlation of the magnitudes, by the model's own.
    pub spectral_correlation: f64,
    /// RMS of the nine bands' errors, dB, by the model's own magnitudes.
    pub band_error_rms_db: f64,
    /// RMS error over third-octave bands, dB, by the model's own magnitudes.
    pub third_octave_error_rms_db: f64,
    /// RMS over the bins of the decibels between the magnitudes.
    pub log_spectral_distance_db: f64,
    /// Level over the recording's, dB, by the model's own magnitudes.
    pub level_error_db: f64,
    /// Correlation, by what it plays.
    pub samples_spectral_correlation: f64,
    /// RMS of the nine bands' errors, dB, by what it plays.
    pub samples_band_error_rms_db: f64,
    /// Half the range of that error over single renderings, dB.
    pub samples_band_error_spread_db: f64,
    /// RMS error over third-octave bands, dB, by what it plays.
    pub samples_third_octave_error_rms_db: f64,
    /// Log-spectral distance, dB, by what it plays.
    pub samples_log_spectral_distance_db: f64,
    /// Level, dB, by what it plays.
    pub samples_level_error_db: f64,
    /// Whether no other setting that plays at its defaults has as few bytes and as small an error,
    /// and less of one (error by magnitudes).
    pub on_front: bool,
    /// Whether no other setting with blocks and output rate at their defaults takes as little time
    /// and has as small an error, and less of one (error by samples).
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
            Kind::Model(model, _) => Some(model.descriptor()),
            _ => None,
        };
        let (magnitude, samples) = (measured.by_magnitude, measured.by_samples);
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
            samples_spectral_correlation: samples.spectral_correlation,
            samples_band_error_rms_db: samples.band_error_rms_db,
            samples_band_error_spread_db: measured.samples_spread_db,
            samples_third_octave_error_rms_db: samples.third_octave_error_rms_db,
            samples_log_spectral_distance_db: samples.log_spectral_distance_db,
            samples_level_error_db: samples.level_error_db,
            on_front: false,
            on_time_front: false,
        }
    }

    /// The error, dB, by the model's own magnitudes.
    pub fn error_db(&self, measure: ErrorMeasure) -> f64 {
        match measure {
            ErrorMeasure::NineBand => self.band_error_rms_db,
            ErrorMeasure::ThirdOctave => self.third_octave_error_rms_db,
            ErrorMeasure::LogSpectral => self.log_spectral_distance_db,
        }
    }

    /// The error, dB, by what it plays.
    pub fn samples_error_db(&self, measure: ErrorMeasure) -> f64 {
        match measure {
            ErrorMeasure::NineBand => self.samples_band_error_rms_db,
            ErrorMeasure::ThirdOctave => self.samples_third_octave_error_rms_db,
            ErrorMeasure::LogSpectral => self.samples_log_spectral_distance_db,
        }
    }

    /// Model and setting.
    pub fn name(&self) -> String {
        format!("{} {}", self.model, self.setting)
    }

    /// Whether it is a baseline.
    pub fn is_baseline(&self) -> bool {
        self.model == QUANTISED || self.model == RECORDING
    }
}
