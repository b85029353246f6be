//! Documents, held to schemas. Nothing is fetched: a `$ref` leads into the schema itself.

use std::error::Error;

use jsonschema::{Retrieve, Uri, Validator};
use serde_json::Value;

/// Violations that are told; a hostile document could break rules by the million.
const MOST: usize = 1000;

/// A schema that documents can be held to.
///
/// ```
/// use serde_json::json;
/// let schema = json!({ "properties": { "threads": { "minimum": 1 } } });
/// let schema = htex_schema::Schema::new(&schema)?;
/// let violations = schema.violations(&json!({ "threads": 0 }));
/// assert_eq!(violations[0].pointer, "/threads");
/// assert_eq!(violations[0].rule, "/properties/threads/minimum");
/// # Ok::<(), htex_schema::SchemaError>(())
/// ```
#[derive(Debug)]
pub struct Schema(Validator);

/// A schema cannot be used.
#[derive(Debug)]
pub struct SchemaError(String);

/// A rule of a schema that a document breaks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// JSON pointer into the document.
    pub pointer: String,
    /// JSON pointer into the schema: the keyword that does not hold, last.
    pub rule: String,
    /// What does not hold.
    pub message: String,
}

/// What a schema refers to outside itself.
struct Nothing;

impl Retrieve for Nothing {
    fn retrieve(&self, _uri: &Uri<String>) -> Result<Value, Box<dyn Error + Send + Sync>> {
        Err("nothing is fetched; put what it refers to into its own $defs".into())
    }
}

impl Schema {
    /// Reads a schema of draft 2020-12, or of the draft that its `$schema` names.
    ///
    /// # Errors
    /// When it is not a valid schema, or refers to another one.
    pub fn new(schema: &Value) -> Result<Self, SchemaError> {
        let validator = jsonschema::options().with_retriever(Nothing).build(schema);
        validator.map(Self).map_err(|e| SchemaError(e.to_string()))
    }

    /// The rules that a document breaks, in the order of the schema; at most the first thousand.
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

impl std::fmt::Display for SchemaError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl Error for SchemaError {}
