//! Validates documents against JSON Schemas. Nothing is downloaded: a `$ref` must refer to a part
//! of the same schema.

use std::error::Error;

use jsonschema::{Retrieve, Uri, ValidationError, Validator};
use serde_json::Value;

/// Largest number of violations that are reported. A hostile document could have millions of
/// violations.
const MOST: usize = 1000;

/// A compiled JSON Schema.
///
/// ```
/// use serde_json::json;
/// let schema = json!({ "properties": { "threads": { "minimum": 1 } } });
/// let schema = htex_base::schema::Schema::new(&schema)?;
/// let violations = schema.violations(&json!({ "threads": 0 }));
/// assert_eq!(violations[0].pointer, "/threads");
/// assert_eq!(violations[0].rule, "/properties/threads/minimum");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Schema(Validator);

/// A violation of a schema.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// JSON pointer into the document.
    pub pointer: String,
    /// JSON pointer into the schema; it ends with the violated keyword.
    pub rule: String,
    pub message: String,
}

/// A retriever that refuses all references outside the schema.
struct Nothing;

impl Retrieve for Nothing {
    fn retrieve(&self, _uri: &Uri<String>) -> Result<Value, Box<dyn Error + Send + Sync>> {
        Err("nothing is fetched; copy the target of the reference into the schema's own $defs"
            .into())
    }
}

impl Schema {
    /// Compiles a schema, whose draft is 2020-12 or the draft that its `$schema` names.
    ///
    /// # Errors
    /// Returns an error if `schema` is not a valid schema, or refers to another schema.
    pub fn new(schema: &Value) -> Result<Self, ValidationError<'static>> {
        jsonschema::options().with_retriever(Nothing).build(schema).map(Self)
    }

    /// Returns how a document violates the schema: at most the first thousand violations, in the
    /// order of the schema.
    pub fn violations(&self, document: &Value) -> Vec<Violation> {
        let errors = self.0.iter_errors(document);
        errors
            .take(MOST)
            .map(|error| Violation {
                pointer: error.instance_path().to_string(),
                rule: error.schema_path().to_string(),
                message: error.to_string(),
            })
            .collect()
    }
}
