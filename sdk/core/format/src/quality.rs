//! How accurately a representation reproduces the recorded spectrum: the manifest's keys `quality`
//! and `left_out`. The module [`crate::quality_json`] reads and writes the values of both keys as
//! JSON.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::measure::{By, Measure};

/// The value of each measure of how well a model agrees with a recorded spectrum. A measure that
/// was not computed has no value.
///
/// ```
/// use htex_format::{Measure, Measures};
/// let measures = Measures::from([(Measure::NineBand, 1.5)]);
/// assert_eq!(measures.get(Measure::NineBand), Some(1.5));
/// assert_eq!(measures.get(Measure::Felt), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measures([Option<f64>; Measure::ALL.len()]);

impl Measures {
    /// Computes the value of every measure.
    pub fn new(value: impl FnMut(Measure) -> Option<f64>) -> Self {
        Self(Measure::ALL.map(value))
    }

    /// Returns a measure's value, or `None` if the measure was not computed.
    pub fn get(&self, measure: Measure) -> Option<f64> {
        self.0[measure as usize]
    }

    /// Returns a mutable reference to a measure's value.
    pub fn get_mut(&mut self, measure: Measure) -> &mut Option<f64> {
        &mut self.0[measure as usize]
    }

    /// Returns a copy with only the given measures.
    pub fn only(&self, measures: impl IntoIterator<Item = Measure>) -> Self {
        let mut only = Self::default();
        for measure in measures {
            *only.get_mut(measure) = self.get(measure);
        }
        only
    }

    /// Returns the keys and values of the given measures. A missing value is `null` in JSON.
    pub fn keyed(&self, by: By, measures: impl IntoIterator<Item = Measure>) -> KeyedMeasures {
        let entry = |measure: Measure| (measure.key(by), self.get(measure));
        KeyedMeasures(measures.into_iter().map(entry).collect())
    }
}

impl<const N: usize> From<[(Measure, f64); N]> for Measures {
    fn from(values: [(Measure, f64); N]) -> Self {
        let mut measures = Self::default();
        for (measure, value) in values {
            *measures.get_mut(measure) = Some(value);
        }
        measures
    }
}

/// Pairs of a key and a value, in a fixed order. In JSON they are one object.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct KeyedMeasures(pub Vec<(&'static str, Option<f64>)>);

impl Serialize for Measures {
    /// Writes only the measures that have a value.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let known = Measure::ALL.into_iter().filter(|m| self.get(*m).is_some());
        self.keyed(By::Magnitude, known).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Measures {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values: BTreeMap<String, Option<f64>> = Deserialize::deserialize(deserializer)?;
        Ok(Self::new(|m| values.get(m.row().key).copied().flatten()))
    }
}

impl Serialize for KeyedMeasures {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

/// How well a model agrees with the recorded spectrum. All numbers refer to the model's magnitudes
/// unless stated otherwise.
///
/// ```no_run
/// use htex_format::{Asset, Measure};
/// let asset = Asset::open("sandpaper.htex".as_ref())?;
/// for at in &asset.manifest.representations[0].at {
///     println!("{:?} dB", at.quality.as_ref().and_then(|q| q.get(Measure::ThirdOctave)));
/// }
/// # Ok::<(), htex_format::ReadError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Quality {
    /// The measures computed from the model's magnitudes.
    pub by_magnitude: Measures,
    /// The measures computed from rendered samples.
    pub by_samples: Measures,
    /// The model's energy in each of nine bands, relative to the recording's energy, decibels.
    pub band_error_db: Vec<f64>,
    /// Error that rounding for storage causes, decibels. It is the nine-band RMS difference between
    /// two spectra: the spectrum of the fitted parameters, and the spectrum of the stored
    /// parameters.
    pub rounding_error_db: Option<f64>,
}

impl Quality {
    /// Returns a measure computed from the model's magnitudes, or `None` if it is not stored.
    pub fn get(&self, measure: Measure) -> Option<f64> {
        self.by_magnitude.get(measure)
    }

    /// Returns a measure computed from rendered samples, or `None` if it is not stored.
    pub fn samples(&self, measure: Measure) -> Option<f64> {
        self.by_samples.get(measure)
    }
}

/// Left-out error near a condition: a fit leaves out some recorded blocks, and is then compared
/// with these blocks. This type contains the measures whose [`crate::MeasureRow::left_out`] is set.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeftOut(pub Measures);

/// The held-out error of a representation at a condition: the third-octave error, measured on
/// recorded blocks that the fit did not use.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct HeldOut {
    /// The error, decibels.
    pub held_out_error_db: f64,
    /// The error divided by the difference between the odd and the even blocks of the recording. If
    /// the value is 1, the error is as large as the difference between two recordings. `None` if
    /// this difference is not known, or 0.
    pub held_out_error: Option<f64>,
}

impl LeftOut {
    /// Returns the measures that a left-out error contains.
    pub fn measures() -> impl Iterator<Item = Measure> + Clone {
        Measure::ALL.into_iter().filter(|m| m.row().left_out)
    }
}
