use clap::Args;
use htex_base::finding::plain;
use htex_base::storage::Location;

use super::install::{Consent, Installation, install_from};
use crate::failure::{Exit, Failure, Result};
use crate::installed::InstalledPlugin;
use crate::output::print;
use crate::plugin_registry::PluginRegistry;

/// Install newer versions of installed plugins from a registry
///
/// For each plugin, the command installs the newest version with the same major version, as `htex
/// plugin install` does. If the command cannot install a plugin, it still updates the other
/// plugins.
#[derive(Args)]
pub(crate) struct Update {
    /// Ids of the plugins [default: all that are installed and in the registry]
    ids: Vec<String>,

    /// Registry: a folder, or an address
    #[arg(long, value_name = "DIR|URL")]
    registry: String,

    #[command(flatten)]
    consent: Consent,
}

impl Update {
    pub(crate) fn run(self) -> Result {
        let registry = PluginRegistry::at(Location::parse(self.registry.as_ref())?)?;
        let mut ids: Vec<String> = if self.ids.is_empty() {
            InstalledPlugin::all()?.into_iter().map(|one| one.id).collect()
        } else {
            self.ids.clone()
        };
        ids.sort();
        ids.dedup();
        let mut is_clean = true;
        for id in ids {
            match update(&registry, &id, &self.consent) {
                Ok(Some(installation)) => print(&installation.to_string())?,
                Ok(None) => print(&format!("{id}: there is no newer version\n"))?,
                // If no id was given, only the plugins that are in the registry are updated.
                Err(Failure::Usage(_)) if self.ids.is_empty() => {}
                Err(error) => {
                    is_clean = false;
                    eprintln!("htex: {}", plain(&error.to_string()));
                }
            }
        }
        Ok(Exit::ok_if(is_clean))
    }
}

fn update(registry: &PluginRegistry, id: &str, consent: &Consent) -> Result<Option<Installation>> {
    let installed = InstalledPlugin::named(id)?;
    let newest = installed.first().ok_or_else(|| {
        Failure::Usage(format!("`{}` is not installed; `htex plugin install` does it", plain(id)))
    })?;
    let entry = registry.entry(id)?;
    let is_newer = |version: &semver::Version| {
        *version > newest.version && version.major == newest.version.major
    };
    if entry.newest(is_newer).is_none() {
        return Ok(None);
    }
    install_from(registry, &entry, is_newer, consent).map(Some)
}
