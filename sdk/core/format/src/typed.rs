//! Deserializer from JSON values to Rust types that is stricter than serde's. It refuses an array
//! where an object is expected, an object where a string with the name of an enum variant is
//! expected, and `null` where a typed value is expected.
//!
//! JSON is parsed only once: first the text becomes a JSON value without duplicate keys, and then
//! this value becomes a Rust type. The conversion to the Rust type also yields the JSON pointers of
//! errors and unknown keys.
//!
//! The project has its own deserializer because serde_json accepts an array for a derived struct,
//! and `null` for an optional key. With serde_json, htex would accept files that other readers of
//! `spec/htex-1.md` refuse. The packages `serde_path_to_error` and `serde_ignored` are no
//! replacement. They only report the paths of errors and of unknown keys, and they miss unknown
//! keys next to the key of an enum variant.

use std::cell::RefCell;
use std::fmt::{self, Write};
use std::iter::Enumerate;
use std::slice;

use serde::de::value::{BorrowedStrDeserializer, MapDeserializer, SeqDeserializer};
use serde::de::{
    self, DeserializeOwned, DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer,
    Unexpected, VariantAccess, Visitor,
};
use serde::forward_to_deserialize_any;
use serde_json::{Map, Value};

use htex_base::finding::escape;

/// Largest integer in a document. A 64-bit float represents all integers up to this number exactly.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Error for a value of the wrong type, with the JSON pointer to the value.
#[derive(Debug)]
pub(crate) struct TypeError {
    pub(crate) pointer: String,
    pub(crate) message: String,
}

/// Converts the value to a `T` and returns it with pointers to the unknown keys.
pub(crate) fn typed<T: DeserializeOwned>(value: &Value) -> Result<(T, Vec<String>), TypeError> {
    let walk = Walk::default();
    match T::deserialize(Typed { value, walk: &walk }) {
        Ok(typed) => Ok((typed, walk.unknown.into_inner())),
        Err(TypeError { message, .. }) => {
            let pointer = walk.pointer();
            Err(TypeError { pointer, message })
        }
    }
}

/// The traversal of a value.
#[derive(Default)]
struct Walk<'de> {
    /// Path to the value that is being read: the current child, or the parent after all its
    /// children were read. After an error, the path stays at the value with the error.
    /// [`Self::pointer`] turns the path into a JSON pointer only on request. If this were done at
    /// each key, reading a manifest of 1 kB would take 4.0 us instead of 2.2 us.
    way: RefCell<Vec<Step<'de>>>,
    /// Pointers to the unknown keys found so far.
    unknown: RefCell<Vec<String>>,
}

/// A step from a value to a value inside it.
enum Step<'de> {
    Key(&'de str),
    Element(usize),
}

impl<'de> Walk<'de> {
    /// Returns the length of the path, for [`Self::return_to`].
    fn here(&self) -> usize {
        self.way.borrow().len()
    }

    fn return_to(&self, here: usize) {
        self.way.borrow_mut().truncate(here);
    }

    fn enter(&self, child: Step<'de>) {
        self.way.borrow_mut().push(child);
    }

    fn pointer(&self) -> String {
        let mut pointer = String::new();
        for step in self.way.borrow().iter() {
            // Writing to a string cannot fail.
            let _ = match step {
                Step::Key(key) => write!(pointer, "/{}", escape(key)),
                Step::Element(index) => write!(pointer, "/{index}"),
            };
        }
        pointer
    }

    /// Adds the current place to the unknown keys.
    fn skip(&self) {
        self.unknown.borrow_mut().push(self.pointer());
    }
}

/// A value, and the traversal that has reached this value.
#[derive(Clone, Copy)]
struct Typed<'de, 'w> {
    value: &'de Value,
    walk: &'w Walk<'de>,
}

impl<'de> Typed<'de, '_> {
    /// Deserializes an integer up to 2^53, even if it is written as `1.0` or `1e0`.
    fn whole<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeError> {
        let size = self.value.as_u64().or(self.value.as_i64().map(i64::unsigned_abs));
        if let Some(size) = size.filter(|size| *size > EXACT as u64) {
            let got = Unexpected::Unsigned(size);
            return Err(de::Error::invalid_type(got, &"a whole number up to 2^53"));
        }
        let number = self.value.as_number().filter(|number| number.is_f64());
        let whole = number
            .and_then(|number| number.as_f64())
            .filter(|x| x.fract() == 0.0 && x.abs() <= EXACT);
        match whole {
            Some(x) if x < 0.0 => visitor.visit_i64(x as i64),
            Some(x) => visitor.visit_u64(x as u64),
            None => self.deserialize_any(visitor),
        }
    }

    fn items<V: Visitor<'de>>(self, list: &'de [Value], visitor: V) -> Result<V::Value, TypeError> {
        let (walk, here) = (self.walk, self.walk.here());
        let values = list.iter().enumerate();
        let items = Items { values, walk, here };
        let mut items = SeqDeserializer::new(items);
        let visited = visitor.visit_seq(&mut items)?;
        let end: Result<(), TypeError> = items.end();
        end.map_err(|_| de::Error::custom("there are too many elements"))?;
        Ok(visited)
    }

    fn entries<V: Visitor<'de>>(
        self,
        map: &'de Map<String, Value>,
        visitor: V,
    ) -> Result<V::Value, TypeError> {
        let (walk, here) = (self.walk, self.walk.here());
        let mut entries = map.iter();
        visitor.visit_map(MapDeserializer::new(std::iter::from_fn(|| {
            walk.return_to(here);
            let (key, value) = entries.next()?;
            walk.enter(Step::Key(key));
            Some((name(key), Typed { value, walk }))
        })))
    }
}

/// The elements of a list. The iterator reports the number of remaining elements, so that the
/// memory for a list of numbers is allocated only once.
struct Items<'de, 'w> {
    values: Enumerate<slice::Iter<'de, Value>>,
    walk: &'w Walk<'de>,
    here: usize,
}

impl<'de, 'w> Iterator for Items<'de, 'w> {
    type Item = Typed<'de, 'w>;

    fn next(&mut self) -> Option<Self::Item> {
        let walk = self.walk;
        walk.return_to(self.here);
        let (index, value) = self.values.next()?;
        walk.enter(Step::Element(index));
        Some(Typed { value, walk })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.values.size_hint()
    }
}

fn name(key: &str) -> BorrowedStrDeserializer<'_, TypeError> {
    BorrowedStrDeserializer::new(key)
}

/// Implements methods that deserialize integers, also in notations such as `1.0` and `1e0`.
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
        match self.value {
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::String(text) => visitor.visit_borrowed_str(text),
            Value::Array(list) => self.items(list, visitor),
            Value::Object(map) => self.entries(map, visitor),
            Value::Number(number) => match (number.as_u64(), number.as_i64()) {
                (Some(whole), _) => visitor.visit_u64(whole),
                (None, Some(whole)) => visitor.visit_i64(whole),
                (None, None) => visitor.visit_f64(number.as_f64().unwrap_or(f64::NAN)),
            },
        }
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

    /// Deserializes an object. Without this method, derived types would also accept an array.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TypeError> {
        if self.value.is_array() {
            return Err(de::Error::invalid_type(Unexpected::Seq, &visitor));
        }
        self.deserialize_any(visitor)
    }

    /// Deserializes a variant from a string, or from an object with the variant's key. Reports the
    /// other keys of that object as unknown keys.
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TypeError> {
        let walk = self.walk;
        let map = match self.value {
            Value::String(word) => {
                let value = None;
                return visitor.visit_enum(Variant { word, value, walk });
            }
            Value::Object(map) => map,
            _ => return self.deserialize_any(visitor),
        };
        let is_known = |key: &str| variants.contains(&key);
        let mut known = map.iter().filter(|(key, _)| is_known(key));
        let Some((word, value)) = known.next() else {
            let message = format!("the object has none of the keys {}", variants.join(", "));
            return Err(de::Error::custom(message));
        };
        if let Some((other, _)) = known.next() {
            let message = format!("{word:?} and {other:?} cannot both be given");
            return Err(de::Error::custom(message));
        }
        let here = walk.here();
        for key in map.keys().filter(|key| !is_known(key)) {
            walk.enter(Step::Key(key));
            walk.skip();
            walk.return_to(here);
        }
        let value = Some(value);
        visitor.visit_enum(Variant { word, value, walk })
    }

    /// Skips the value of a key that the type does not know.
    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, TypeError> {
        self.walk.skip();
        visitor.visit_unit()
    }

    forward_to_deserialize_any! {
        bool i8 i16 i128 u128 f32 f64 char str string bytes byte_buf unit unit_struct
        seq tuple tuple_struct map identifier
    }
}

impl<'de> IntoDeserializer<'de, TypeError> for Typed<'de, '_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

/// A variant: a string, or the only known key of an object together with its value.
struct Variant<'de, 'w> {
    word: &'de str,
    value: Option<&'de Value>,
    walk: &'w Walk<'de>,
}

impl<'de, 'w> Variant<'de, 'w> {
    fn content(self) -> Result<Typed<'de, 'w>, TypeError> {
        let (word, walk) = (self.word, self.walk);
        let Some(value) = self.value else {
            let message = format!("{word:?} needs a value; write {{{word:?}: ...}}");
            return Err(de::Error::custom(message));
        };
        walk.enter(Step::Key(word));
        Ok(Typed { value, walk })
    }
}

impl<'de> EnumAccess<'de> for Variant<'de, '_> {
    type Error = TypeError;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), TypeError> {
        Ok((seed.deserialize(name(self.word))?, self))
    }
}

impl<'de> VariantAccess<'de> for Variant<'de, '_> {
    type Error = TypeError;

    fn unit_variant(self) -> Result<(), TypeError> {
        let word = self.word;
        match self.value {
            None => Ok(()),
            Some(_) => {
                Err(de::Error::custom(format!("{word:?} has no value; write {word:?} as a string")))
            }
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, TypeError> {
        seed.deserialize(self.content()?)
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, TypeError> {
        self.content()?.deserialize_tuple(len, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, TypeError> {
        self.content()?.deserialize_struct("", fields, visitor)
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
        Self { pointer: String::new(), message: message.to_string() }
    }
}

/// Translates the description of an expected type from Rust terms to JSON terms.
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
