//! JSON Schemas (draft 2020-12) of htex's documents: made from Rust types, and checked against.
//!
//! ```
//! #[derive(schemars::JsonSchema)]
//! struct Cloth {
//!     /// Threads a centimetre.
//!     threads: f64,
//!     dye: Option<String>,
//! }
//! let schema = htex_schema::document::<Cloth>("cloth-1.json", "Cloth");
//! assert_eq!(schema["$id"], "https://htex.org/schemas/cloth-1.json");
//! assert_eq!(schema["properties"]["dye"]["type"], "string");
//! assert_eq!(schema["properties"]["threads"].get("format"), None);
//! ```
#![forbid(unsafe_code)]

#[cfg(feature = "check")]
mod check;

#[cfg(feature = "check")]
pub use check::{Schema, SchemaError, Violation};

use schemars::transform::transform_subschemas;
use schemars::{JsonSchema, Schema as Made, SchemaGenerator};
use serde_json::{Value, json};

/// What the schemas' names start with; nothing is fetched from there.
const BASE: &str = "https://htex.org/schemas/";

/// The schema of a document in which what is not known is left out, never `null`; `file` is its
/// name in `spec/schemas`.
pub fn document<T: JsonSchema>(file: &str, title: &str) -> Value {
    let mut schema = made::<T>(file, title);
    without_null(&mut schema);
    schema.to_value()
}

/// The schema of what crosses an ABI as JSON, where `null` stands for what is absent.
pub fn crossing<T: JsonSchema>(file: &str, title: &str) -> Value {
    made::<T>(file, title).to_value()
}

fn made<T: JsonSchema>(file: &str, title: &str) -> Made {
    let mut schema = SchemaGenerator::default().into_root_schema_for::<T>();
    schema.insert("$id".to_owned(), json!(format!("{BASE}{file}")));
    schema.insert("title".to_owned(), json!(title));
    without_formats(&mut schema);
    schema
}

/// Takes out formats such as `double` and `uint64`, which the standard does not have.
fn without_formats(schema: &mut Made) {
    schema.remove("format");
    transform_subschemas(&mut (without_formats as fn(&mut Made)), schema);
}

/// Takes out `null` beside another type.
fn without_null(schema: &mut Made) {
    transform_subschemas(&mut (without_null as fn(&mut Made)), schema);
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = &types[..] {
            let only = only.clone();
            schema.insert("type".to_owned(), only);
        }
    }
    if schema.get("default") == Some(&Value::Null) {
        schema.remove("default");
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
