//! Plugins in the user's own folders.

use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, OwnFolder};
use htex_base::native::description::{description_path, read_descriptor};
use htex_base::native::folders::{data_or_new, libraries_in};
use htex_build::registry::PluginKind;
use serde::Deserialize;

use crate::failure::{Failure, Result};
use crate::keys::{Signer, signature_path};

/// Returns the user's folder for plugins of this kind, which need not exist.
pub(crate) fn folder_of(kind: PluginKind) -> Result<PathBuf> {
    let name = match kind {
        PluginKind::Model => "htex/plugins",
        PluginKind::Device => "htex/devices",
    };
    data_or_new(name)
        .ok_or_else(|| Failure::other("there is no folder for plugins: set HOME or XDG_DATA_HOME"))
}

/// A plugin in one of the user's folders.
#[derive(Debug, Clone)]
pub(crate) struct InstalledPlugin {
    pub(crate) kind: PluginKind,
    pub(crate) id: String,
    pub(crate) version: semver::Version,
    pub(crate) file: PathBuf,
}

/// The part of a descriptor that identifies a plugin.
#[derive(Deserialize)]
pub(crate) struct Identity {
    pub(crate) id: String,
    pub(crate) version: semver::Version,
}

impl InstalledPlugin {
    /// Returns the plugins whose descriptor can be read without running them. `htex plugin install`
    /// writes only such plugins.
    pub(crate) fn all() -> Result<Vec<Self>> {
        let mut all = Vec::new();
        for kind in [PluginKind::Model, PluginKind::Device] {
            let folder = folder_of(kind)?;
            if !folder.is_dir() {
                continue;
            }
            for file in libraries_in(&folder, Some("wasm")).reading(&folder)? {
                let Some(json) = read_descriptor(&file).reading(&file)? else { continue };
                let Ok(Identity { id, version }) = serde_json::from_str(&json) else { continue };
                all.push(Self { kind, id, version, file });
            }
        }
        Ok(all)
    }

    /// Returns the plugins with this id, the newest first.
    pub(crate) fn named(id: &str) -> Result<Vec<Self>> {
        let mut named: Vec<Self> = Self::all()?.into_iter().filter(|one| one.id == id).collect();
        named.sort_by(|a, b| b.version.cmp(&a.version));
        Ok(named)
    }

    /// Returns who signed the plugin.
    pub(crate) fn signer(&self) -> Result<Option<Signer>> {
        Signer::of_plugin(&self.file)
    }

    /// Removes the plugin's file, and the signature and the description beside it.
    pub(crate) fn remove(&self) -> Result<()> {
        // The plugin's file is removed first, because the other two files have no meaning without
        // it.
        for path in [&self.file, &signature_path(&self.file), &description_path(&self.file)] {
            remove(path)?;
        }
        Ok(())
    }
}

/// Removes a file of the user's folder, if it is there.
pub(crate) fn remove(path: &Path) -> Result<()> {
    let (folder, name) = OwnFolder::of_file(path).writing(path)?;
    match folder.remove(&name) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        removed => Ok(removed.writing(path)?),
    }
}

/// Returns the name of a plugin's file in the user's folder.
pub(crate) fn file_name(id: &str, version: &semver::Version, file: &Path) -> String {
    let is_module = file.extension().is_some_and(|extension| extension == "wasm");
    let extension = if is_module { "wasm" } else { std::env::consts::DLL_EXTENSION };
    format!("{id}-{version}.{extension}")
}
