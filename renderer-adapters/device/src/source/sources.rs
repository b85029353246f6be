//! The sources that a program can find.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::registry::{AdapterKind, Known, Registry};
use crate::source::abi::SourceTable;
use crate::source::{NativeSourceAdapter, Source, SourceAdapter};
use crate::{Descriptor, DeviceError, Endpoint, Settings};

/// Source adapters, by id and by short name.
pub type Sources = Registry<dyn SourceAdapter>;
/// A source adapter that was found.
pub type KnownSource = Known<dyn SourceAdapter>;

impl AdapterKind for dyn SourceAdapter {
    type Table = SourceTable;
    const WORD: &'static str = "source";
    const VARIABLE: &'static str = "HTEX_SOURCE_PATH";
    const FOLDER: &'static str = "htex/sources";

    fn about(&self) -> &Descriptor {
        self.descriptor()
    }

    fn connected(&self) -> Result<Vec<Endpoint>, DeviceError> {
        self.endpoints()
    }

    fn of_native(native: NativeSourceAdapter) -> Arc<Self> {
        Arc::new(native)
    }

    fn unknown(wanted: String, known: String) -> DeviceError {
        DeviceError::UnknownSource { wanted, known }
    }
}

impl Sources {
    /// Opens the source named by a text `NAME:TARGET`, e.g. `file:rec.csv` or `daq:Dev1/ai0:5`,
    /// with a profile and further settings. The part after the first colon becomes the value of the
    /// setting that [`SourceAdapter::target`] names.
    ///
    /// # Errors
    /// When the name is not known, a setting is not usable, or the source cannot be opened.
    pub fn open(
        &self,
        text: &str,
        profile: Option<&str>,
        given: &BTreeMap<String, String>,
    ) -> Result<Box<dyn Source>, DeviceError> {
        let (name, target) = match text.split_once(':') {
            Some((name, target)) => (name, Some(target)),
            None => (text, None),
        };
        let adapter = &self.find(name)?.adapter;
        let mut given = given.clone();
        if let Some(target) = target {
            given.insert(adapter.target().to_owned(), target.to_owned());
        }
        adapter.open(&Settings::resolve(adapter.descriptor(), profile, &given)?)
    }
}
