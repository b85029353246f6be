//! The JSON documents that callers pass to the functions of this module. Each function takes
//! entries out of its document by name.
//!
//! Only the tables of settings are read with code that `serde` derives. Such code adds a kilobyte
//! or more to the module for each struct, so all other documents are read without it.

#[cfg(feature = "make")]
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::refusal::Refusal;

/// A JSON object from which entries are taken.
pub(crate) struct Document {
    left: Map<String, Value>,
    known: Vec<&'static str>,
}

impl Document {
    /// Reads the document of a call.
    pub(crate) fn of_call(json: &[u8]) -> Result<Self, Refusal> {
        let value = serde_json::from_slice::<Value>(json).map_err(Refusal::argument)?;
        Self::from_value(value)
    }

    /// Makes a document from an object. `null` entries count as absent.
    pub(crate) fn from_value(value: Value) -> Result<Self, Refusal> {
        match value {
            Value::Object(mut left) => {
                left.retain(|_, value| !value.is_null());
                Ok(Self { left, known: Vec::new() })
            }
            Value::Null => Self::from_value(Value::Object(Map::new())),
            other => Err(Refusal::argument(format!("{other} is not an object"))),
        }
    }

    fn remove(&mut self, name: &'static str) -> Option<Value> {
        // Stored for the error of `finish`, which lists all names that the function knows.
        self.known.push(name);
        self.left.remove(name)
    }

    /// Takes the entries whose names are in a table of settings.
    #[cfg(feature = "make")]
    pub(crate) fn table<T: DeserializeOwned>(
        &mut self,
        names: &[&'static str],
    ) -> Result<T, Refusal> {
        let mut own = Map::new();
        for name in names {
            if let Some(value) = self.remove(name) {
                own.insert((*name).to_owned(), value);
            }
        }
        serde_json::from_value(Value::Object(own)).map_err(Refusal::argument)
    }

    pub(crate) fn object(&mut self, name: &'static str) -> Result<Self, Refusal> {
        Self::from_value(self.remove(name).unwrap_or_default())
    }

    /// Takes an object as it is, with its `null` entries. If it is absent, it is empty.
    #[cfg(feature = "make")]
    pub(crate) fn map(&mut self, name: &'static str) -> Result<Map<String, Value>, Refusal> {
        match self.remove(name) {
            None => Ok(Map::new()),
            Some(Value::Object(all)) => Ok(all),
            Some(_) => Err(wrong(name, "an object")),
        }
    }

    /// Takes a list. If it is absent, the list is empty.
    pub(crate) fn list(&mut self, name: &'static str) -> Result<Vec<Value>, Refusal> {
        match self.remove(name) {
            None => Ok(Vec::new()),
            Some(Value::Array(all)) => Ok(all),
            Some(_) => Err(wrong(name, "a list")),
        }
    }

    pub(crate) fn texts(&mut self, name: &'static str) -> Result<Vec<String>, Refusal> {
        let text = |value| match value {
            Value::String(text) => Ok(text),
            _ => Err(wrong(name, "a list of texts")),
        };
        self.list(name)?.into_iter().map(text).collect()
    }

    pub(crate) fn text(&mut self, name: &'static str) -> Result<Option<String>, Refusal> {
        match self.remove(name) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(_) => Err(wrong(name, "a text")),
        }
    }

    pub(crate) fn number(&mut self, name: &'static str) -> Result<Option<f64>, Refusal> {
        match self.remove(name) {
            None => Ok(None),
            Some(value) => number(&value).map(Some).ok_or_else(|| wrong(name, "a number")),
        }
    }

    pub(crate) fn flag(&mut self, name: &'static str) -> Result<bool, Refusal> {
        match self.remove(name) {
            None => Ok(false),
            Some(Value::Bool(is)) => Ok(is),
            Some(_) => Err(wrong(name, "true or false")),
        }
    }

    /// Returns whether there is an entry of this name.
    #[cfg(feature = "import")]
    pub(crate) fn has(&self, name: &str) -> bool {
        self.left.contains_key(name)
    }

    /// Takes the remaining entries, whose names the caller chose.
    pub(crate) fn rest(self) -> Map<String, Value> {
        self.left
    }

    /// Returns an error if entries remain, because their names are unknown.
    pub(crate) fn finish(self) -> Result<(), Refusal> {
        match self.left.keys().next() {
            None => Ok(()),
            Some(name) => {
                let (name, known) = (htex_base::finding::plain(name), self.known.join(", "));
                let sentence = format!("there is no {name}; there are {known}");
                Err(Refusal::argument(sentence))
            }
        }
    }
}

/// A finite number.
pub(crate) fn number(value: &Value) -> Option<f64> {
    // JSON has no NaN and no infinity, so every number is finite.
    value.as_f64()
}

fn wrong(name: &str, wanted: &str) -> Refusal {
    Refusal::argument(format!("{name} is {wanted}"))
}
