//! Deserializer from JSON values to types, stricter than serde's: an array is not accepted for an
//! object, an object not for a string variant, and `null` not for a key of a type.
//!
//! JSON is parsed once: a text becomes a value without duplicate keys, and the value becomes a type. JSON pointers come
//! from the same traversal.

use std::cell::RefCell;
use std::fmt;

use serde::de::value::BorrowedStrDeserializer;
use serde::de::{
    self, DeserializeOwned, DeserializeSeed, Deserializer, EnumAccess, MapAccess, SeqAccess,
    Unexpected, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;
use serde_json::{Map, Value};

use htex_finding::Place;

/// Largest integer up to which every integer is exact in binary64.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Error of a value that does not have its type, with its place.
#[derive(Debug)]
pub(crate) struct TypeError {
    pub(crate) pointer: Option<String>,
    pub(crate) message: String,
}

/// Converts the value to a `T` and returns it with pointers to the unknown keys.
pub(crate) fn typed<T: DeserializeOwned>(value: &Value) -> Result<(T, Vec<String>), TypeError> {
    let unknown = RefCell::new(Vec::new());
    let typed = T::deserialize(Typed {
        value,
        place: &Place::Root,
        unknown: &unknown,
    })?;
    Ok((typed, unknown.into_inner()))
}

/// A value at a place.
#[derive(Clone, Copy)]
struct Typed<'de, 'p> {
    value: &'de Value,
    place: &'p Place<'p>,
    unknown: &'p RefCell<Vec<String>>,
}

impl<'de> Typed<'de, '_> {
    /// Deserializes an integer, also if it is written as `1.0` or `1e0`.
    fn whole<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeError> {
        let number = self.value.as_number().filter(|number| number.is_f64());
        let whole = number
            .and_then(|number| number.as_f64())
            .filter(|x| x.fract() == 0.0 && x.abs() <= EXACT);
        let visited = match whole {
            Some(x) if x < 0.0 => visitor.visit_i64(x as i64),
            Some(x) => visitor.visit_u64(x as u64),
            None => return self.deserialize_any(visitor),
        };
        self.placed(visited)
    }

    fn wrong<V: Visitor<'de>>(self, visitor: &V) -> TypeError {
        let found = match self.value {
            Value::Null => Unexpected::Unit,
            Value::Bool(value) => Unexpected::Bool(*value),
            Value::String(text) => Unexpected::Str(text),
            Value::Array(_) => Unexpected::Seq,
            Value::Object(_) => Unexpected::Map,
            Value::Number(number) => Unexpected::Float(number.as_f64().unwrap_or(f64::NAN)),
        };
        self.here(de::Error::invalid_type(found, visitor))
    }

    /// Adds this place to the error, unless it has a deeper one.
    fn here(self, mut error: TypeError) -> TypeError {
        error.pointer.get_or_insert_with(|| self.place.pointer());
        error
    }

    fn placed<T>(self, result: Result<T, TypeError>) -> Result<T, TypeError> {
        result.map_err(|error| self.here(error))
    }

    fn items<V: Visitor<'de>>(self, list: &'de [Value], visitor: V) -> Result<V::Value, TypeError> {
        let mut items = Items {
            parent: self,
            rest: list,
            index: 0,
        };
        let visited = self.placed(visitor.visit_seq(&mut items))?;
        match items.rest {
            [] => Ok(visited),
            _ => Err(self.here(de::Error::custom("there are too many elements"))),
        }
    }

    fn entries<V: Visitor<'de>>(
        self,
        map: &'de Map<String, Value>,
        visitor: V,
    ) -> Result<V::Value, TypeError> {
        let entries = Entries {
            parent: self,
            rest: map.iter(),
            next: None,
        };
        self.placed(visitor.visit_map(entries))
    }
}

/// Implements methods that deserialize integers in any notation.
macro_rules! whole_numbers {
    ($($name:ident)*) => {
        $(fn $name<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeError> {
            self.whole(visitor)
        })*
    };
}

impl<'de> Deserializer<'de> for Typed<'de, '_> {
    type Error = TypeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeError> {
        let visited = match self.value {
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::String(text) => visitor.visit_borrowed_str(text),
            Value::Array(list) => return self.items(list, visitor),
            Value::Object(map) => return self.entries(map, visitor),
            Value::Number(number) => match (number.as_u64(), number.as_i64()) {
                (Some(whole), _) => visitor.visit_u64(whole),
                (None, Some(whole)) => visitor.visit_i64(whole),
                (None, None) => visitor.visit_f64(number.as_f64().unwrap_or(f64::NAN)),
            },
        };
        self.placed(visited)
    }

    whole_numbers! {
        deserialize_i64 deserialize_i32 deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64
    }

    /// Deserializes an optional key, which may be absent but not `null`.
    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeError> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, TypeError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeError> {
        match self.value {
            Value::Array(list) => self.items(list, visitor),
            _ => Err(self.wrong(&visitor)),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        _len: usize,
        visitor: V,
    ) -> Result<V::Value, TypeError> {
        self.deserialize_seq(visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeError> {
        match self.value {
            Value::Object(map) => self.entries(map, visitor),
            _ => Err(self.wrong(&visitor)),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TypeError> {
        self.deserialize_map(visitor)
    }

    /// Deserializes a string, or an object with a variant's key; other keys beside it are unknown keys.
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TypeError> {
        let map = match self.value {
            Value::String(word) => {
                let variant = Variant {
                    parent: self,
                    word,
                    value: None,
                };
                return self.placed(visitor.visit_enum(variant));
            }
            Value::Object(map) => map,
            _ => return Err(self.wrong(&visitor)),
        };
        let is_known = |key: &str| variants.contains(&key);
        let mut known = map.iter().filter(|(key, _)| is_known(key));
        let Some((word, value)) = known.next() else {
            let message = format!("the object has none of the keys {}", variants.join(", "));
            return Err(self.here(de::Error::custom(message)));
        };
        if let Some((other, _)) = known.next() {
            let message = format!("{word:?} and {other:?} cannot both be given");
            return Err(self.here(de::Error::custom(message)));
        }
        for key in map.keys().filter(|key| !is_known(key)) {
            let place = Place::Key(self.place, key);
            self.unknown.borrow_mut().push(place.pointer());
        }
        let variant = Variant {
            parent: self,
            word,
            value: Some(value),
        };
        self.placed(visitor.visit_enum(variant))
    }

    /// Skips the value of a key that the type does not know.
    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeError> {
        self.unknown.borrow_mut().push(self.place.pointer());
        visitor.visit_unit()
    }

    forward_to_deserialize_any! {
        bool i8 i16 i128 u128 f32 f64 char str string bytes byte_buf unit unit_struct
        tuple_struct identifier
    }
}

/// The elements of an array.
struct Items<'de, 'p> {
    parent: Typed<'de, 'p>,
    rest: &'de [Value],
    index: usize,
}

impl<'de> SeqAccess<'de> for &mut Items<'de, '_> {
    type Error = TypeError;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, TypeError> {
        let Some((value, rest)) = self.rest.split_first() else {
            return Ok(None);
        };
        self.rest = rest;
        let place = &Place::Index(self.parent.place, self.index);
        self.index += 1;
        let unknown = self.parent.unknown;
        seed.deserialize(Typed {
            value,
            place,
            unknown,
        })
        .map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

/// The entries of an object.
struct Entries<'de, 'p> {
    parent: Typed<'de, 'p>,
    rest: serde_json::map::Iter<'de>,
    next: Option<(&'de str, &'de Value)>,
}

impl<'de> MapAccess<'de> for Entries<'de, '_> {
    type Error = TypeError;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, TypeError> {
        let Some((key, value)) = self.rest.next() else {
            return Ok(None);
        };
        self.next = Some((key, value));
        let read = seed.deserialize(BorrowedStrDeserializer::<TypeError>::new(key));
        let place = &Place::Key(self.parent.place, key);
        Typed {
            value,
            place,
            ..self.parent
        }
        .placed(read)
        .map(Some)
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, TypeError> {
        let Some((key, value)) = self.next.take() else {
            return Err(de::Error::custom("a value without a key"));
        };
        let place = &Place::Key(self.parent.place, key);
        let unknown = self.parent.unknown;
        seed.deserialize(Typed {
            value,
            place,
            unknown,
        })
    }
}

/// A variant: a string, or the only known key of an object with its value.
struct Variant<'de, 'p> {
    parent: Typed<'de, 'p>,
    word: &'de str,
    value: Option<&'de Value>,
}

impl Variant<'_, '_> {
    fn needs_a_value(&self) -> TypeError {
        let word = self.word;
        de::Error::custom(format!("{word:?} needs a value; write {{{word:?}: ...}}"))
    }
}

impl<'de> EnumAccess<'de> for Variant<'de, '_> {
    type Error = TypeError;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), TypeError> {
        let name = BorrowedStrDeserializer::<TypeError>::new(self.word);
        Ok((seed.deserialize(name)?, self))
    }
}

impl<'de> VariantAccess<'de> for Variant<'de, '_> {
    type Error = TypeError;

    fn unit_variant(self) -> Result<(), TypeError> {
        let word = self.word;
        match self.value {
            None => Ok(()),
            Some(_) => Err(de::Error::custom(format!(
                "{word:?} has no value; write {word:?} as a string"
            ))),
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, TypeError> {
        let value = self.value.ok_or_else(|| self.needs_a_value())?;
        let place = &Place::Key(self.parent.place, self.word);
        let unknown = self.parent.unknown;
        seed.deserialize(Typed {
            value,
            place,
            unknown,
        })
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, TypeError> {
        let value = self.value.ok_or_else(|| self.needs_a_value())?;
        let place = &Place::Key(self.parent.place, self.word);
        Typed {
            value,
            place,
            ..self.parent
        }
        .deserialize_tuple(len, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TypeError> {
        let value = self.value.ok_or_else(|| self.needs_a_value())?;
        let place = &Place::Key(self.parent.place, self.word);
        Typed {
            value,
            place,
            ..self.parent
        }
        .deserialize_struct("", fields, visitor)
    }
}

impl fmt::Display for TypeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for TypeError {}

impl de::Error for TypeError {
    fn invalid_type(found: Unexpected<'_>, expected: &dyn de::Expected) -> Self {
        let found = match found {
            Unexpected::Unit => "null".to_owned(),
            Unexpected::Seq => "an array".to_owned(),
            Unexpected::Map => "an object".to_owned(),
            Unexpected::Float(x) => format!("the number {x}"),
            Unexpected::Unsigned(x) => format!("the number {x}"),
            Unexpected::Signed(x) => format!("the number {x}"),
            other => other.to_string(),
        };
        Self::custom(format!("expected {}, found {found}", in_words(expected)))
    }

    fn custom<T: fmt::Display>(message: T) -> Self {
        Self {
            pointer: None,
            message: message.to_string(),
        }
    }
}

/// Translates what a type expects from Rust to JSON terms.
fn in_words(expected: &dyn de::Expected) -> String {
    let rust = expected.to_string();
    let words = match rust.as_str() {
        "f64" | "f32" => "a number",
        "usize" | "u64" | "u32" | "u16" | "u8" | "i64" => "an integer",
        "a boolean" => "true or false",
        "a sequence" => "an array",
        _ if rust == "a map" || rust.starts_with("struct ") => "an object",
        _ if rust.starts_with("enum ") => "a string or an object with one key",
        _ => return rust,
    };
    words.to_owned()
}
