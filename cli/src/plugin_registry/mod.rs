//! Registries of plugins: a folder, or a place on the web, with one TOML file for each plugin
//! (`docs/signatures.md`).

pub(crate) mod add;
pub(crate) mod check;
pub(crate) mod page;

use htex_base::finding::plain;
use htex_base::storage::{Location, Storage};
use htex_build::registry::{Entry, PlatformFile};
use htex_format::signing::read_signature_at;

use crate::failure::{Failure, Result};

/// The folder of a registry with the entries.
pub(crate) const ENTRIES: &str = "plugins";
/// The largest entry, bytes.
const MOST_ENTRY_BYTES: u64 = 1 << 20;
/// The largest plugin, bytes.
pub(crate) const MOST_PLUGIN_BYTES: u64 = 1 << 28;

/// A registry at a path or a URI.
pub(crate) struct PluginRegistry {
    place: Location,
    storage: Storage,
}

/// A plugin's file and its signature.
pub(crate) struct Fetched {
    pub(crate) file: Vec<u8>,
    pub(crate) signature: Vec<u8>,
}

impl PluginRegistry {
    pub(crate) fn at(place: Location) -> Result<Self> {
        Ok(Self { place, storage: Storage::from_environment()? })
    }

    /// Returns the entry of a plugin.
    pub(crate) fn entry(&self, id: &str) -> Result<Entry> {
        if !htex_model::is_model_id(id) {
            let id = plain(id);
            return Err(Failure::Usage(format!("`{id}` is not the id of a plugin, nor a file")));
        }
        let location = self.place.inside(&format!("{ENTRIES}/{id}.toml"));
        if !self.storage.exists(&location)? {
            let place = self.place.to_string();
            return Err(Failure::Usage(format!("{}: no plugin `{id}` is there", plain(&place))));
        }
        let bytes = self.storage.read(&location, MOST_ENTRY_BYTES)?;
        let entry = Entry::parse(&bytes)
            .map_err(|problem| Failure::Other(format!("{location}: {problem}")))?;
        if entry.id != id {
            let own = plain(&entry.id).into_owned();
            return Err(Failure::Other(format!("{location}: it is the entry of {own}")));
        }
        Ok(entry)
    }

    /// Fetches a file of an entry, and its signature.
    pub(crate) fn fetch(&self, file: &PlatformFile) -> Result<Fetched> {
        // The address comes from the registry, so it may lead only to the registry itself and to
        // the internet.
        let storage = Storage::from_environment()?.for_names_in_a_file(Some(&self.place));
        let text = &file.file;
        let location = if text.contains("://") {
            Location::parse(text.as_ref())?
        } else {
            self.place.inside(text)
        };
        let signature = read_signature_at(&storage, &location)?.ok_or_else(|| {
            Failure::Other(format!("{location}: the registry has no signature of this file"))
        })?;
        Ok(Fetched { file: storage.read(&location, MOST_PLUGIN_BYTES)?, signature })
    }
}
