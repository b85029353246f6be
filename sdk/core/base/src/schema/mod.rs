//! Generates the JSON Schemas (draft 2020-12) of htex's documents from Rust types, and validates
//! documents with them.
//!
//! ```
//! /// A cloth.
//! ///
//! /// ```
//! /// println!("an example in Rust");
//! /// ```
//! #[derive(schemars::JsonSchema)]
//! struct Cloth {
//!     /// Threads per centimetre.
//!     threads: f64,
//!     dye: Option<String>,
//! }
//! let schema = htex_base::schema::document::<Cloth>("cloth-1.json", "Cloth");
//! assert_eq!(schema["$id"], "https://htex.org/schemas/cloth-1.json");
//! assert_eq!(schema["description"], "A cloth.");
//! assert_eq!(schema["properties"]["dye"]["type"], "string");
//! assert_eq!(schema["properties"]["threads"].get("format"), None);
//! ```
#![forbid(unsafe_code)]

#[cfg(feature = "check")]
mod check;
mod keys;

pub use crate::white_space;
#[cfg(feature = "check")]
pub use check::{Schema, Violation};
pub use keys::{UnknownKey, check_keys, unknown_keys};

use schemars::transform::transform_subschemas;
use schemars::{JsonSchema, Schema as Made, SchemaGenerator};
use serde_json::{Value, json};

/// Prefix of the schemas' ids. Programs never download anything from this address.
const BASE: &str = "https://htex.org/schemas/";

/// The characters with Unicode's property `White_Space`, written for the square brackets of a
/// regular expression. JSON Schema validators differ in the meaning of `\s`, so patterns do not use
/// it.
#[macro_export]
macro_rules! white_space {
    () => {
        r"\u0009-\u000D\u0020\u0085\u00A0\u1680\u2000-\u200A\u2028\u2029\u202F\u205F\u3000"
    };
}

/// Pattern for a text that contains a character other than white space.
pub const NOT_BLANK: &str = concat!("[^", white_space!(), "]");

/// Returns the schema of a document. A document omits the key of a missing value; it never sets the
/// key to `null`. `file` is the file name of the schema in `spec/schemas`.
pub fn document<T: JsonSchema>(file: &str, title: &str) -> Value {
    let mut schema = made::<T>(file, title);
    without_null(&mut schema);
    schema.to_value()
}

/// Returns the schema of JSON that is passed through an ABI. In such JSON, `null` stands for a
/// missing value.
pub fn crossing<T: JsonSchema>(file: &str, title: &str) -> Value {
    made::<T>(file, title).to_value()
}

fn made<T: JsonSchema>(file: &str, title: &str) -> Made {
    let mut schema = SchemaGenerator::default().into_root_schema_for::<T>();
    schema.insert("$id".to_owned(), json!(format!("{BASE}{file}")));
    schema.insert("title".to_owned(), json!(title));
    without_formats(&mut schema);
    without_examples(&mut schema);
    schema
}

/// Removes Rust examples from the descriptions in a schema. These descriptions are the doc comments
/// of the Rust types.
fn without_examples(schema: &mut Made) {
    if let Some(Value::String(text)) = schema.get_mut("description") {
        while let Some((before, code)) = text.split_once("```") {
            let after = code.split_once("```").map_or("", |(_, after)| after);
            *text = format!("{}{}", before.trim_end(), after.trim_end());
        }
    }
    transform_subschemas(&mut (without_examples as fn(&mut Made)), schema);
}

/// Largest integer in documents: up to it, binary64 represents every integer exactly.
const EXACT: i64 = 1 << 53;

/// Removes formats such as `double` and `uint64`, which the standard does not define. Formats of
/// integers are replaced by ranges.
fn without_formats(schema: &mut Made) {
    let format = schema.remove("format");
    let range = match format.as_ref().and_then(Value::as_str) {
        Some("int32") => Some((i32::MIN.into(), i32::MAX.into())),
        Some("uint8") => Some((0, u8::MAX.into())),
        Some("uint16") => Some((0, u16::MAX.into())),
        Some("uint32") => Some((0, u32::MAX.into())),
        Some("int" | "int64") => Some((-EXACT, EXACT)),
        Some("uint" | "uint64") => Some((0, EXACT)),
        _ => None::<(i64, i64)>,
    };
    // Schemas that are just `true` or `false` stay as they are.
    if let Some((least, most)) = range {
        let object = schema.ensure_object();
        object.entry("minimum").or_insert(json!(least));
        object.entry("maximum").or_insert(json!(most));
    }
    transform_subschemas(&mut (without_formats as fn(&mut Made)), schema);
}

/// Removes keys whose value is `null`.
fn remove_null(value: &mut Value) {
    if let Value::Object(map) = value {
        map.retain(|_, value| !value.is_null());
        map.values_mut().for_each(remove_null);
    }
}

/// Removes the type `null` where it is an alternative to another type.
fn without_null(schema: &mut Made) {
    transform_subschemas(&mut (without_null as fn(&mut Made)), schema);
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = &types[..] {
            let only = only.clone();
            schema.insert("type".to_owned(), only);
        }
    }
    match schema.get_mut("default") {
        Some(Value::Null) => drop(schema.remove("default")),
        Some(default) => remove_null(default),
        None => {}
    }
    let Some(Value::Array(choices)) = schema.get_mut("anyOf") else {
        return;
    };
    choices.retain(|choice| *choice != json!({ "type": "null" }));
    if let [Value::Object(only)] = &choices[..] {
        let only = only.clone();
        schema.remove("anyOf");
        schema.ensure_object().extend(only);
    }
}
