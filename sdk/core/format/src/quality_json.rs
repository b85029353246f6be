//! JSON of `quality` and `left_out`. The keys of these two JSON objects come from the table of
//! measures. This module reads, writes and checks these objects. The module `quality_schema`
//! describes them in the JSON Schema.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{self, DeserializeSeed, IgnoredAny, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::measure::{By, Measure, MeasureKind};
use crate::quality::{LeftOut, Quality};

/// Key of the nine band errors. It comes before the key of their RMS.
const BANDS: &str = "band_error_db";
/// Number of bands of `band_error_db`.
pub(crate) const BAND_COUNT: usize = 9;
const ROUNDING: &str = "rounding_error_db";
/// Largest number of keys in an object.
const KEYS: usize = 2 * Measure::ALL.len() + 2;

/// A key with its value.
pub(crate) struct Entry<'a> {
    pub(crate) key: &'static str,
    pub(crate) content: Content<'a>,
    pub(crate) required: bool,
    #[cfg_attr(not(feature = "schemars"), expect(dead_code, reason = "for the schema"))]
    pub(crate) description: &'static str,
}

pub(crate) enum Content<'a> {
    Number(Option<f64>, MeasureKind),
    Bands(&'a [f64]),
}

/// The place to which the value of a key is written when the object is read.
pub(crate) enum Slot<'a> {
    Number(&'a mut Option<f64>),
    Bands(&'a mut Vec<f64>),
}

/// An object whose keys come from the table of measures.
pub(crate) trait Entries: Default {
    const NAME: &'static str;
    #[cfg_attr(not(feature = "schemars"), expect(dead_code, reason = "for the schema"))]
    const DESCRIPTION: &'static str;
    /// Returns all keys in file order, including keys without a value.
    fn entries(&self) -> impl Iterator<Item = Entry<'_>>;

    /// Looks up a key without copying it. Returns the place to which its value is written, or
    /// `None` if the key is unknown.
    fn slot(&mut self, key: &str) -> Option<(&'static str, Slot<'_>)>;
}

impl Entries for Quality {
    const NAME: &'static str = "Quality";
    const DESCRIPTION: &'static str =
        "Agreement with the recorded spectrum, of the model's magnitudes unless stated otherwise.";

    fn entries(&self) -> impl Iterator<Item = Entry<'_>> {
        let by_magnitude = Measure::stored().flat_map(|measure| {
            let bands = (measure == Measure::NineBand).then_some(Entry {
                key: BANDS,
                content: Content::Bands(&self.band_error_db),
                required: true,
                description: "Energy relative to the recording's in nine bands, decibels.",
            });
            let number = Entry {
                key: measure.row().key,
                content: Content::Number(self.get(measure), measure.row().judged),
                required: measure.row().required,
                description: measure.row().meaning,
            };
            bands.into_iter().chain([number])
        });
        let by_samples = Measure::stored().filter_map(|measure| {
            let row = measure.row();
            Some(Entry {
                key: row.samples_key,
                content: Content::Number(self.samples(measure), row.judged),
                required: false,
                description: row.of_samples?,
            })
        });
        let rounding = Entry {
            key: ROUNDING,
            content: Content::Number(self.rounding_error_db, MeasureKind::Error),
            required: false,
            description: "Nine-band RMS difference between the spectra of the fitted and of the stored parameters, decibels.",
        };
        by_magnitude.chain(by_samples).chain([rounding])
    }

    fn slot(&mut self, key: &str) -> Option<(&'static str, Slot<'_>)> {
        let (by, values) = match key {
            BANDS => return Some((BANDS, Slot::Bands(&mut self.band_error_db))),
            ROUNDING => return Some((ROUNDING, Slot::Number(&mut self.rounding_error_db))),
            key if key.starts_with("samples_") => (By::Samples, &mut self.by_samples),
            _ => (By::Magnitude, &mut self.by_magnitude),
        };
        let has = |m: &Measure| by == By::Magnitude || m.row().of_samples.is_some();
        let found = Measure::stored().find(|m| m.key(by) == key && has(m))?;
        Some((found.key(by), Slot::Number(values.get_mut(found))))
    }
}

impl Entries for LeftOut {
    const NAME: &'static str = "LeftOut";
    const DESCRIPTION: &'static str = "Left-out error: how well a fit without certain blocks of time plays the spectra of these blocks.";

    fn entries(&self) -> impl Iterator<Item = Entry<'_>> {
        let entry = |measure: Measure| Entry {
            key: measure.row().key,
            content: Content::Number(self.0.get(measure), measure.row().judged),
            required: measure.row().required,
            description: measure.row().meaning,
        };
        Self::measures().map(entry)
    }

    fn slot(&mut self, key: &str) -> Option<(&'static str, Slot<'_>)> {
        let found = Self::measures().find(|m| m.row().key == key)?;
        Some((found.row().key, Slot::Number(self.0.get_mut(found))))
    }
}

fn write<T: Entries, S: Serializer>(object: &T, serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(None)?;
    for Entry { key, content, .. } in object.entries() {
        match content {
            Content::Number(None, _) => {}
            Content::Number(Some(value), _) => map.serialize_entry(key, &value)?,
            Content::Bands(errors) => map.serialize_entry(key, errors)?,
        }
    }
    map.end()
}

struct Reader<T>(PhantomData<T>);

impl<'de, T: Entries> Visitor<'de> for Reader<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The text has the wording of serde's derived types. The reader of manifests turns it into
        // "an object".
        write!(f, "struct {}", T::NAME)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<T, A::Error> {
        let (mut object, mut found) = (T::default(), Vec::with_capacity(KEYS));
        while let Some(known) = map.next_key_seed(Key(&mut object))? {
            match known {
                None => drop(map.next_value::<IgnoredAny>()?),
                Some((key, slot)) => {
                    found.push(key);
                    match slot {
                        Slot::Number(number) => *number = map.next_value()?,
                        Slot::Bands(errors) => *errors = map.next_value()?,
                    }
                }
            }
        }
        let missing = |e: &Entry<'_>| e.required && !found.contains(&e.key);
        if let Some(Entry { key, .. }) = object.entries().find(missing) {
            return Err(de::Error::custom(format!("missing field `{key}`")));
        }
        Ok(object)
    }
}

/// Deserializes a key of an object without copying it.
struct Key<'a, T>(&'a mut T);

impl<'de, 'a, T: Entries> DeserializeSeed<'de> for Key<'a, T> {
    type Value = Option<(&'static str, Slot<'a>)>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl<'a, T: Entries> Visitor<'_> for Key<'a, T> {
    type Value = Option<(&'static str, Slot<'a>)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: de::Error>(self, key: &str) -> Result<Self::Value, E> {
        Ok(self.0.slot(key))
    }
}

macro_rules! in_json {
    ($($name:ident)*) => {$(
        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                write(self, serializer)
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                // The object is deserialized as a struct and not as a map, so that the reader of
                // manifests refuses an array here.
                deserializer.deserialize_struct(Self::NAME, &[], Reader(PhantomData))
            }
        }
    )*};
}

in_json!(Quality LeftOut);
