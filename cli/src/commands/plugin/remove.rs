use clap::Args;
use htex_base::finding::plain;

use crate::failure::{Exit, Failure, Result};
use crate::installed::InstalledPlugin;
use crate::output::print;

/// Remove plugins from your own folder
#[derive(Args)]
pub(crate) struct Remove {
    /// Id of the plugin
    id: String,

    /// Remove only this version
    #[arg(long, value_name = "VERSION")]
    version: Option<semver::Version>,
}

impl Remove {
    pub(crate) fn run(self) -> Result {
        let wanted = |one: &InstalledPlugin| {
            self.version.as_ref().is_none_or(|version| *version == one.version)
        };
        let named: Vec<InstalledPlugin> =
            InstalledPlugin::named(&self.id)?.into_iter().filter(wanted).collect();
        if named.is_empty() {
            let id = plain(&self.id);
            return Err(Failure::Usage(format!(
                "`{id}` is not installed in your folder; `htex plugin list` shows what is used"
            )));
        }
        for one in named {
            one.remove()?;
            print(&format!("removed {} {}\n", one.id, one.version))?;
        }
        Ok(Exit::SUCCESS)
    }
}
