//! Finds unknown keys: keys of a document that its schema does not contain.

use serde_json::{Map, Value};

/// A key of a document that the schema does not contain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownKey {
    /// The path from the root of the document to the key: keys and indices, and the key itself at
    /// the end.
    pub path: Vec<String>,
    /// The most similar key of the schema, or `None` if no key is similar enough.
    pub nearest: Option<String>,
}

impl std::fmt::Display for UnknownKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "there is no key `{}`", place(&self.path))?;
        match &self.nearest {
            Some(nearest) => write!(f, "; did you mean `{nearest}`?"),
            None => write!(f, "; correct it, or leave it out"),
        }
    }
}

/// Returns a path in the form that messages use: `textures[0].licence`.
fn place(path: &[String]) -> String {
    let is_index = |part: &str| part.bytes().all(|b| b.is_ascii_digit());
    path.iter().fold(String::new(), |place, part| match part {
        index if is_index(index) => format!("{place}[{index}]"),
        key if place.is_empty() => key.clone(),
        key => format!("{place}.{key}"),
    })
}

/// Returns the keys of a document that its schema refuses (`additionalProperties: false`). If the
/// schema has alternatives for a value, the alternative for the value's type applies.
///
/// ```
/// use serde_json::json;
/// let schema = json!({ "type": "object", "properties": { "license": {} }, "additionalProperties": false });
/// let unknown = htex_base::schema::unknown_keys(&schema, &json!({ "licence": "CC0-1.0" }));
/// assert_eq!(unknown[0].to_string(), "there is no key `licence`; did you mean `license`?");
/// ```
pub fn unknown_keys(schema: &Value, document: &Value) -> Vec<UnknownKey> {
    let mut walk = Walk { root: schema, path: Vec::new(), unknown: Vec::new() };
    walk.value(schema, document);
    walk.unknown
}

struct Walk<'a> {
    root: &'a Value,
    path: Vec<String>,
    unknown: Vec<UnknownKey>,
}

impl<'a> Walk<'a> {
    fn value(&mut self, schema: &'a Value, value: &Value) {
        let Some(schema) = self.of_type(schema, value) else {
            return;
        };
        match value {
            Value::Object(object) => self.object(schema, object),
            Value::Array(items) => {
                for (i, item) in items.iter().enumerate() {
                    self.inside(i.to_string(), &schema["items"], item);
                }
            }
            _ => {}
        }
    }

    fn object(&mut self, schema: &'a Value, object: &Map<String, Value>) {
        let others = schema.get("additionalProperties");
        for (key, value) in object {
            match (schema["properties"].get(key), others) {
                (Some(known), _) => self.inside(key.clone(), known, value),
                (None, Some(Value::Bool(false))) => self.refuse(schema, key),
                (None, Some(others)) => self.inside(key.clone(), others, value),
                (None, None) => {}
            }
        }
    }

    fn inside(&mut self, key: String, schema: &'a Value, value: &Value) {
        self.path.push(key);
        self.value(schema, value);
        self.path.pop();
    }

    fn refuse(&mut self, schema: &Value, key: &str) {
        let known = schema["properties"].as_object().into_iter().flatten();
        let nearest = crate::similar(key, known.map(|(known, _)| known.as_str()), 1);
        self.unknown.push(UnknownKey {
            path: self.path.iter().cloned().chain([key.to_owned()]).collect(),
            nearest: nearest.first().map(|known| (*known).to_owned()),
        });
    }

    /// Returns the schema itself or, if it has alternatives, the alternative for the type of the
    /// value.
    fn of_type(&self, schema: &'a Value, value: &Value) -> Option<&'a Value> {
        let reference = schema.get("$ref").and_then(Value::as_str);
        if let Some(pointer) = reference.and_then(|to| to.strip_prefix('#')) {
            return self.of_type(self.root.pointer(pointer)?, value);
        }
        let alternatives = ["anyOf", "oneOf"].iter().find_map(|key| schema.get(*key)?.as_array());
        match alternatives {
            Some(all) => all.iter().find_map(|one| self.of_type(one, value)),
            None => is_of_type(schema, value).then_some(schema),
        }
    }
}

fn is_of_type(schema: &Value, value: &Value) -> bool {
    let name = match value {
        Value::Object(_) => "object",
        Value::Array(_) => "array",
        _ => return true,
    };
    let of = &schema["type"];
    of == name || of.as_array().is_some_and(|all| all.iter().any(|one| one == name))
}
