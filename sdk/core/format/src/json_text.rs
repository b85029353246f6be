//! Parses JSON texts and refuses duplicate keys.

use std::cell::RefCell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::map::Entry;
use serde_json::{Map, Number, Value};

use htex_base::finding::Place;

/// Parses a JSON text and refuses duplicate keys. Some programs use the first value of a duplicate
/// key, and other programs use the last one. The parser itself limits the nesting depth to 128.
///
/// # Errors
/// Returns an error if the text is not JSON, nests too deep, or has a key twice in an object.
///
/// ```
/// assert!(htex_format::parse_json(br#"{ "a": 1, "b": 1 }"#).is_ok());
/// assert!(htex_format::parse_json(br#"{ "a": 1, "a": 1 }"#).is_err());
/// ```
pub fn parse_json(bytes: &[u8]) -> Result<Value, JsonError> {
    // The parser's error contains only a message, so this cell returns the pointer.
    let twice = RefCell::new(None);
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let strict = Strict { place: &Place::Root, twice: &twice };
    let parsed = strict.deserialize(&mut json).and_then(|value| json.end().map(|()| value));
    parsed.map_err(|error| match twice.take() {
        Some(pointer) => JsonError::Twice(pointer),
        None => JsonError::Syntax(error),
    })
}

/// The reason why a JSON text was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JsonError {
    /// The text is not JSON.
    #[error("it is not JSON: {0}")]
    Syntax(#[source] serde_json::Error),
    /// The key at this pointer appears twice in its object.
    #[error("the key {0} appears twice")]
    Twice(String),
}

/// Deserializes the value at one place of the text. It records the pointer of a duplicate key
/// before the parser stops.
#[derive(Clone, Copy)]
struct Strict<'p> {
    place: &'p Place<'p>,
    twice: &'p RefCell<Option<String>>,
}

impl<'de> DeserializeSeed<'de> for Strict<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, json: D) -> Result<Value, D::Error> {
        json.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Strict<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(Value::Number(value.into()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(Value::Number(value.into()))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        let number = Number::from_f64(value);
        number.map(Value::Number).ok_or_else(|| E::custom("number out of range"))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(Value::String(value.to_owned()))
    }

    fn visit_string<E>(self, value: String) -> Result<Value, E> {
        Ok(Value::String(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        loop {
            let place = &Place::Index(self.place, list.len());
            match items.next_element_seed(Strict { place, ..self })? {
                Some(item) => list.push(item),
                None => return Ok(Value::Array(list)),
            }
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut map = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            match map.entry(key) {
                Entry::Occupied(entry) => {
                    let place = Place::Key(self.place, entry.key());
                    self.twice.replace(Some(place.pointer()));
                    return Err(A::Error::custom("a key appears twice"));
                }
                Entry::Vacant(entry) => {
                    let place = &Place::Key(self.place, entry.key());
                    let value = entries.next_value_seed(Strict { place, ..self })?;
                    entry.insert(value);
                }
            }
        }
        Ok(Value::Object(map))
    }
}
