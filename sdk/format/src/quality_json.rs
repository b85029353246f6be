//! `quality` and `left_out` in JSON: their keys, from the table of measures, with which they are read, written, checked and described.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{self, IgnoredAny, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};

use crate::measure::{By, Judged, Measure};
use crate::quality::{LeftOut, Quality};

/// Key of the nine errors, before that of their RMS.
const BANDS: &str = "band_error_db";
/// Number of bands of `band_error_db`.
pub(crate) const BAND_COUNT: usize = 9;
const ROUNDING: &str = "rounding_error_db";

/// A key with its value.
pub(crate) struct Entry<'a> {
    pub(crate) key: &'static str,
    pub(crate) content: Content<'a>,
    required: bool,
    description: &'static str,
}

pub(crate) enum Content<'a> {
    Number(Option<f64>, Judged),
    Bands(&'a [f64]),
}

/// Where the value of a key is read to.
pub(crate) enum Slot<'a> {
    Number(&'a mut Option<f64>),
    Bands(&'a mut Vec<f64>),
}

/// An object whose keys come from the table of measures.
pub(crate) trait Entries: Default {
    const NAME: &'static str;
    const DESCRIPTION: &'static str;

    /// Returns all keys in the order of the file, also those without a value.
    fn entries(&self) -> Vec<Entry<'_>>;

    /// Returns the place of a key's value; `None` if the key is not known.
    fn slot(&mut self, key: &str) -> Option<Slot<'_>>;
}

impl Entries for Quality {
    const NAME: &'static str = "Quality";
    const DESCRIPTION: &'static str =
        "Agreement with the recorded spectrum, of the model's magnitudes unless stated otherwise.";

    fn entries(&self) -> Vec<Entry<'_>> {
        let mut entries = Vec::with_capacity(2 * Measure::ALL.len() + 2);
        for measure in Measure::stored() {
            if measure == Measure::NineBand {
                entries.push(Entry {
                    key: BANDS,
                    content: Content::Bands(&self.band_error_db),
                    required: true,
                    description: "Energy relative to the recording's in nine bands, decibels.",
                });
            }
            let (row, value) = (measure.row(), self.get(measure));
            entries.push(Entry {
                key: row.key,
                content: Content::Number(value, row.judged),
                required: row.required,
                description: row.meaning,
            });
        }
        for measure in Measure::stored() {
            let row = measure.row();
            entries.extend(row.of_samples.map(|description| Entry {
                key: measure.key(By::Samples),
                content: Content::Number(self.samples(measure), row.judged),
                required: false,
                description,
            }));
        }
        entries.push(Entry {
            key: ROUNDING,
            content: Content::Number(self.rounding_error_db, Judged::Error),
            required: false,
            description: "Nine-band RMS difference between the spectra of the fitted and of the stored parameters, decibels.",
        });
        entries
    }

    fn slot(&mut self, key: &str) -> Option<Slot<'_>> {
        let mut stored = Measure::stored();
        match (key, key.strip_prefix("samples_")) {
            (BANDS, _) => Some(Slot::Bands(&mut self.band_error_db)),
            (ROUNDING, _) => Some(Slot::Number(&mut self.rounding_error_db)),
            (_, Some(key)) => {
                let found = stored.find(|m| m.row().key == key && m.row().of_samples.is_some())?;
                Some(Slot::Number(self.by_samples.get_mut(found)))
            }
            (key, None) => {
                let found = stored.find(|m| m.row().key == key)?;
                Some(Slot::Number(self.by_magnitude.get_mut(found)))
            }
        }
    }
}

impl Entries for LeftOut {
    const NAME: &'static str = "LeftOut";
    const DESCRIPTION: &'static str = "Leave-one-out error: agreement with the recorded spectrum of what a player interpolates at a condition without its own\nparameters.";

    fn entries(&self) -> Vec<Entry<'_>> {
        let entry = |measure: Measure| Entry {
            key: measure.key(By::Magnitude),
            content: Content::Number(self.0.get(measure), measure.row().judged),
            required: measure.row().required,
            description: measure.row().meaning,
        };
        Self::measures().map(entry).collect()
    }

    fn slot(&mut self, key: &str) -> Option<Slot<'_>> {
        let found = Self::measures().find(|m| m.row().key == key)?;
        Some(Slot::Number(self.0.get_mut(found)))
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
        write!(f, "struct {}", T::NAME)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<T, A::Error> {
        let (mut object, mut found) = (T::default(), Vec::new());
        while let Some(key) = map.next_key::<String>()? {
            match object.slot(&key) {
                Some(Slot::Number(number)) => *number = map.next_value()?,
                Some(Slot::Bands(errors)) => *errors = map.next_value()?,
                None => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
            found.push(key);
        }
        let required = T::default();
        let mut entries = required.entries().into_iter().filter(|e| e.required);
        match entries.find(|e| found.iter().all(|key| key != e.key)) {
            Some(Entry { key, .. }) => Err(de::Error::custom(format!("missing field `{key}`"))),
            None => Ok(object),
        }
    }
}

fn schema<T: Entries>() -> Schema {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    for entry in T::default().entries() {
        let mut property = match entry.content {
            Content::Bands(_) => json!({
                "type": "array", "items": { "type": "number" }, "minItems": BAND_COUNT, "maxItems": BAND_COUNT,
            }),
            Content::Number(_, Judged::Correlation) => {
                json!({ "type": "number", "minimum": -1, "maximum": 1 })
            }
            Content::Number(_, Judged::Error) => {
                json!({ "type": "number", "minimum": 0 })
            }
            Content::Number(..) => json!({ "type": "number" }),
        };
        property["description"] = entry.description.into();
        if entry.required {
            required.push(Value::from(entry.key));
        }
        properties.insert(entry.key.into(), property);
    }
    schemars::json_schema!({
        "type": "object", "description": T::DESCRIPTION, "properties": properties, "required": required,
    })
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
                deserializer.deserialize_struct(Self::NAME, &[], Reader(PhantomData))
            }
        }

        impl JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                Self::NAME.into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                schema::<Self>()
            }
        }
    )*};
}

in_json!(Quality LeftOut);
