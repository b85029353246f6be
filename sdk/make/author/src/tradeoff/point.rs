//! The measurements of one setting on one recording.

use std::collections::BTreeMap;

use crate::FeltError;
use htex_format::{By, KeyedMeasures, Measure, MeasureKind, Measures};
use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::tradeoff::contender::{Contender, ContenderKind};
use crate::tradeoff::measurement::Measurement;
use crate::tradeoff::timing::Times;
use crate::tradeoff::{Setting, Subject};

/// Model name of the first baseline: the spectrum, quantised to one byte per bin.
pub(crate) const QUANTISED: &str = "quantised-spectrum";
/// Name used in place of a model's name for the baseline that plays the recording.
pub const RECORDING: &str = "recording";

/// Cost and accuracy of one setting on one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    pub recording: String,
    /// Short name of the model, `quantised-spectrum` or [`RECORDING`].
    pub model: String,
    /// The values of all knobs, including knobs that have their default value.
    pub knobs: BTreeMap<String, Value>,
    /// The knobs whose values differ from their defaults, as text.
    pub setting: String,
    #[serde(skip)]
    pub how: Setting,
    /// Median time of a fit, ms.
    pub fit_ms: f64,
    /// Half the interquartile range of the fit times, divided by their median.
    pub fit_spread: f64,
    /// Median time from stored parameters to the first sample, microseconds.
    pub first_sample_us: f64,
    /// Half the interquartile range of the times to the first sample, divided by their median.
    pub first_sample_spread: f64,
    /// Median time per output sample, nanoseconds.
    pub ns_per_sample: f64,
    /// Half the interquartile range of the times per sample, divided by their median.
    pub spread: f64,
    /// Size of the stored parameters, bytes. For the baseline that plays the recording: size of the
    /// single-precision samples.
    pub bytes: usize,
    /// Memory that the playback needs for a stored loop or a filter, bytes.
    pub kept_bytes: usize,
    /// Held-out error: the model is fitted to the odd blocks of a recording and played. The result
    /// is compared with the even blocks in third octaves. The unit of this error is the difference
    /// between the odd and the even blocks of the recording. A model with an error of 1 is
    /// therefore as good as a second recording. `None` if there are too few blocks.
    pub held_out_error: Option<f64>,
    /// The held-out error in decibels.
    pub held_out_error_db: Option<f64>,
    /// All measures of [`Measure::of_both`], computed on the model's magnitudes.
    #[serde(flatten, serialize_with = "of_magnitudes")]
    pub by_magnitude: Measures,
    /// Shares of the recordings with a small difference. For a single recording, a share is 0 or 1.
    #[serde(flatten)]
    pub shares: Shares,
    /// The measures of rendered samples.
    #[serde(flatten)]
    pub by_samples: RenderedAccuracy,
    /// Whether the point is on the Pareto front of bytes and error. Only settings whose options for
    /// playing have their default values are compared.
    pub on_front: bool,
    /// Whether the point is on the Pareto front of time and error. Only settings with the default
    /// block size, output rate and storage are compared.
    pub on_time_front: bool,
}

/// Shares of the recordings for which the difference between the model's magnitudes and the
/// recording is small. Each share is from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Shares {
    /// Share of the recordings that cannot be felt at all. `below_threshold` and
    /// `below_threshold_if_sensitive` leave these recordings out.
    #[serde(rename = "share_not_felt")]
    pub below_detection: f64,
    /// Share of the recordings whose difference is below the difference threshold, in every third
    /// octave and over all third octaves together.
    #[serde(rename = "share_below_threshold")]
    pub below_threshold: f64,
    /// Share of the recordings whose difference is below the difference threshold of a person with
    /// a sensitive finger and soft skin.
    #[serde(rename = "share_below_threshold_if_sensitive")]
    pub below_threshold_if_sensitive: f64,
    /// Share of the recordings whose difference is within the recording's own variation. This
    /// number does not show what can be felt.
    #[serde(rename = "share_within_repeatability")]
    pub within_repeatability: f64,
}

impl Shares {
    /// Shares of a single recording: each is 0 or 1.
    fn new(felt: &FeltError) -> Self {
        let share = |is: bool| f64::from(u8::from(is));
        Self {
            below_detection: share(felt.below_detection_threshold),
            below_threshold: share(felt.below_difference_threshold),
            below_threshold_if_sensitive: share(felt.below_if_sensitive),
            within_repeatability: share(felt.within_repeatability),
        }
    }

    /// Returns the shares with their keys in JSON.
    pub(crate) fn keyed(&self) -> [(&'static str, f64); 4] {
        [
            ("share_not_felt", self.below_detection),
            ("share_below_threshold", self.below_threshold),
            ("share_below_threshold_if_sensitive", self.below_threshold_if_sensitive),
            ("share_within_repeatability", self.within_repeatability),
        ]
    }
}

/// Returns the error measures of a point.
pub fn errors() -> impl Iterator<Item = Measure> {
    Measure::of_both().filter(|m| m.row().judged == MeasureKind::Error)
}

/// Returns all other measures of a point, which are not errors.
pub fn others() -> impl Iterator<Item = Measure> {
    Measure::of_both().filter(|m| m.row().judged != MeasureKind::Error)
}

/// Accuracy of rendered samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderedAccuracy {
    /// The measures of the mean spectrum of several renderings.
    pub measures: Measures,
    /// Half the range of the nine-band errors of the individual renderings, dB.
    pub band_error_spread_db: f64,
}

fn of_magnitudes<S: Serializer>(measures: &Measures, serializer: S) -> Result<S::Ok, S::Error> {
    let keyed = measures.keyed(By::Magnitude, Measure::of_both());
    keyed.serialize(serializer)
}

impl RenderedAccuracy {
    /// Returns the numbers with their keys. The spread comes after the error to which it belongs.
    pub(crate) fn keyed(&self) -> KeyedMeasures {
        let mut keyed = KeyedMeasures::default();
        for measure in Measure::of_both() {
            keyed.0.extend(self.measures.keyed(By::Samples, [measure]).0);
            if measure == Measure::NineBand {
                let spread = Some(self.band_error_spread_db);
                keyed.0.push(("samples_band_error_spread_db", spread));
            }
        }
        keyed
    }
}

impl Serialize for RenderedAccuracy {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.keyed().serialize(serializer)
    }
}

impl Point {
    pub(crate) fn new(
        subject: &Subject,
        one: &Contender,
        measured: &Measurement,
        timed: &Times,
    ) -> Self {
        let descriptor = match &one.kind {
            ContenderKind::Model(model, _) => Some(model.descriptor()),
            _ => None,
        };
        let floor_db = subject.held_out.as_ref().ok().map(|h| h.floor_db);
        let of_floor = |(error, floor): (f64, f64)| error / floor;
        Self {
            recording: subject.name.clone(),
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
            held_out_error: measured.held_out_error_db.zip(floor_db).map(of_floor),
            held_out_error_db: measured.held_out_error_db,
            by_magnitude: measured.by_magnitude.measures,
            shares: Shares::new(&measured.by_magnitude.felt),
            by_samples: RenderedAccuracy {
                measures: measured.by_samples.measures,
                band_error_spread_db: measured.samples_spread_db,
            },
            on_front: false,
            on_time_front: false,
        }
    }

    /// Returns the value of a measure.
    pub fn get(&self, by: By, measure: Measure) -> f64 {
        let measures = match by {
            By::Magnitude => &self.by_magnitude,
            By::Samples => &self.by_samples.measures,
        };
        measures.get(measure).unwrap_or(f64::NAN)
    }

    /// Returns the model and the setting as text.
    pub fn name(&self) -> String {
        format!("{} {}", self.model, self.setting)
    }

    pub(crate) fn is_baseline(&self) -> bool {
        self.model == QUANTISED || self.model == RECORDING
    }
}
