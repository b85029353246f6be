//! The sources that a program knows.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::{DeviceError, Settings, Source, SourceAdapter};

/// Source adapters by id and by short name.
#[derive(Clone, Default)]
pub struct Sources {
    known: Vec<Arc<dyn SourceAdapter>>,
}

impl Sources {
    /// Those linked into a program. Of several with the same id the first is used.
    #[must_use]
    pub fn new(builtin: Vec<Arc<dyn SourceAdapter>>) -> Self {
        let mut known: Vec<Arc<dyn SourceAdapter>> = Vec::new();
        for adapter in builtin {
            let id = &adapter.descriptor().id;
            if known.iter().all(|other| other.descriptor().id != *id) {
                known.push(adapter);
            }
        }
        Self { known }
    }

    /// All adapters, in their order.
    pub fn all(&self) -> &[Arc<dyn SourceAdapter>] {
        &self.known
    }

    /// An adapter by its id or by its short name (`org.htex.daq` or `daq`, in any case).
    ///
    /// # Errors
    /// [`DeviceError::UnknownSource`] with the known names.
    pub fn find(&self, name: &str) -> Result<&Arc<dyn SourceAdapter>, DeviceError> {
        let by_id = |a: &&Arc<dyn SourceAdapter>| a.descriptor().id == name;
        let by_name =
            |a: &&Arc<dyn SourceAdapter>| a.descriptor().short_name().eq_ignore_ascii_case(name);
        let found = self.known.iter().find(by_id);
        found
            .or_else(|| self.known.iter().find(by_name))
            .ok_or_else(|| {
                let names = self.known.iter().map(|a| a.descriptor().short_name());
                DeviceError::UnknownSource {
                    wanted: name.to_owned(),
                    known: names.collect::<Vec<_>>().join(", "),
                }
            })
    }

    /// Opens the source that a text names, `NAME:TARGET` such as `file:rec.csv` or `daq:Dev1/ai0:5`, with further settings.
    /// What follows the first colon is the value of the adapter's [`SourceAdapter::target`].
    ///
    /// # Errors
    /// When the name is not known, a setting is not usable, or the source cannot be opened.
    pub fn open(
        &self,
        text: &str,
        given: &BTreeMap<String, String>,
    ) -> Result<Box<dyn Source>, DeviceError> {
        let (name, target) = match text.split_once(':') {
            Some((name, target)) => (name, Some(target)),
            None => (text, None),
        };
        let adapter = self.find(name)?;
        let mut given = given.clone();
        if let Some(target) = target {
            given.insert(adapter.target().to_owned(), target.to_owned());
        }
        adapter.open(&Settings::resolve(adapter.descriptor(), None, &given)?)
    }
}

impl std::fmt::Debug for Sources {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names = self.known.iter().map(|a| &a.descriptor().id);
        f.debug_list().entries(names).finish()
    }
}
