//! Agreement of a representation with the recorded spectrum: `quality` and `left_out`. Their JSON
//! is in [`crate::quality_json`].

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::measure::{By, Measure};

/// The value of each measure, where it is known.
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
    /// Measures all.
    pub fn new(value: impl FnMut(Measure) -> Option<f64>) -> Self {
        Self(Measure::ALL.map(value))
    }

    /// Returns a measure's value.
    pub fn get(&self, measure: Measure) -> Option<f64> {
        self.0[measure as usize]
    }

    /// Returns a measure's value to change it.
    pub fn get_mut(&mut self, measure: Measure) -> &mut Option<f64> {
        &mut self.0[measure as usize]
    }

    /// Returns only these measures.
    pub fn only(&self, measures: impl IntoIterator<Item = Measure>) -> Self {
        let mut only = Self::default();
        for measure in measures {
            *only.get_mut(measure) = self.get(measure);
        }
        only
    }

    /// Returns the values of these measures by key; one that is not known is `null` in JSON.
    pub fn keyed(&self, by: By, measures: impl IntoIterator<Item = Measure>) -> Keyed {
        let entry = |measure: Measure| (measure.key(by), self.get(measure));
        Keyed(measures.into_iter().map(entry).collect())
    }

    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.0.iter_mut().flatten()
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

/// Values by key, an object in JSON.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Keyed(pub Vec<(&'static str, Option<f64>)>);

impl Serialize for Measures {
    /// Writes those that are known.
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

impl Serialize for Keyed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(key, value)| (key, value)))
    }
}

/// Agreement with the recorded spectrum, of the model's magnitudes unless stated otherwise.
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
    /// Of the model's magnitudes.
    pub by_magnitude: Measures,
    /// Of rendered samples.
    pub by_samples: Measures,
    /// Energy relative to the recording's in nine bands, decibels.
    pub band_error_db: Vec<f64>,
    /// Nine-band RMS difference between the spectra of the fitted and of the stored parameters,
    /// decibels.
    pub rounding_error_db: Option<f64>,
}

impl Quality {
    /// Returns a measure of the model's magnitudes; `None` if it is not stored.
    pub fn get(&self, measure: Measure) -> Option<f64> {
        self.by_magnitude.get(measure)
    }

    /// Returns a measure of rendered samples; `None` if it is not stored.
    pub fn samples(&self, measure: Measure) -> Option<f64> {
        self.by_samples.get(measure)
    }
}

/// Left-out error: agreement of blocks of time, near a condition, with what a player plays of a fit
/// without them, by the measures whose row has `left_out`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeftOut(pub Measures);

impl LeftOut {
    /// Returns the measures that it has.
    pub fn measures() -> impl Iterator<Item = Measure> + Clone {
        Measure::ALL.into_iter().filter(|m| m.row().left_out)
    }
}
