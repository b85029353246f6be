//! Generates JSON Schemas from Rust types.

use schemars::transform::transform_subschemas;
use schemars::{JsonSchema, Schema as Made, SchemaGenerator};
use serde_json::{Value, json};

use super::unknown_keys;

/// Prefix of the schemas' ids. Programs never download anything from this address.
const BASE: &str = "https://htex.org/schemas/";

/// Returns the schema of a document. A document omits the key of a missing value; it never sets the
/// key to `null`. `file` is the file name of the schema in `spec/schemas`.
///
/// ```
/// /// A cloth.
/// ///
/// /// ```
/// /// println!("an example in Rust");
/// /// ```
/// #[derive(schemars::JsonSchema)]
/// struct Cloth {
///     /// Threads per centimetre.
///     threads: f64,
///     dye: Option<String>,
/// }
/// let schema = htex_base::schema::document::<Cloth>("cloth-1.json", "Cloth");
/// assert_eq!(schema["$id"], "https://htex.org/schemas/cloth-1.json");
/// assert_eq!(schema["description"], "A cloth.");
/// assert_eq!(schema["properties"]["dye"]["type"], "string");
/// assert_eq!(schema["properties"]["threads"].get("format"), None);
/// ```
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

/// Refuses a document with keys that the schema of `T` does not contain.
///
/// # Errors
/// Returns an error if the document has such keys. The error's text has one sentence for each of
/// these keys.
pub fn check_keys<T: JsonSchema>(document: &Value) -> Result<(), String> {
    let schema = crossing::<T>("", "");
    let unknown = unknown_keys(&schema, document);
    let sentences: Vec<String> = unknown.iter().map(ToString::to_string).collect();
    if sentences.is_empty() { Ok(()) } else { Err(sentences.join("\n")) }
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
