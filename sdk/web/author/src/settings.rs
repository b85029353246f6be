//! Settings as one object, whose entries are those of several tables (`htex_author::settings`).

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::refusal::Refusal;

/// The settings of a call, of which each table takes its own.
pub(crate) struct Settings {
    left: Map<String, Value>,
    known: Vec<&'static str>,
}

impl Settings {
    /// `null` stands for the default.
    pub(crate) fn new(mut all: Map<String, Value>) -> Self {
        all.retain(|_, value| !value.is_null());
        Self {
            left: all,
            known: Vec::new(),
        }
    }

    /// Takes the settings of a table, whose names are given.
    pub(crate) fn take<T: DeserializeOwned>(
        &mut self,
        names: &[&'static str],
    ) -> Result<T, Refusal> {
        self.known.extend_from_slice(names);
        let entry = |name: &&str| Some(((*name).to_owned(), self.left.remove(*name)?));
        let own: Map<String, Value> = names.iter().filter_map(entry).collect();
        serde_json::from_value(Value::Object(own)).map_err(Refusal::argument)
    }

    /// Refuses a setting that no table has.
    pub(crate) fn finish(self) -> Result<(), Refusal> {
        match self.left.keys().next() {
            None => Ok(()),
            Some(name) => {
                let (name, known) = (htex_finding::plain(name), self.known.join(", "));
                let sentence = format!("there is no setting {name}; the settings are {known}");
                Err(Refusal::argument(sentence))
            }
        }
    }
}
