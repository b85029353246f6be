use std::fmt::{Display, Formatter};

use clap::Args;
use htex_base::finding::plain;
use htex_host::Registry;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use crate::failure::Result;
use crate::output::show;
use crate::plugins::PluginArgs;

/// List all models, and the plugins that htex found but does not use.
///
/// htex searches for models in this order: --plugin, --plugin-dir, the folders in HTEX_PLUGIN_PATH,
/// the user's folder, the models built into this program.
///
/// If several models have the same id, htex uses the first of these models that --plugin names. If
/// --plugin names none of them, htex takes the major version from the first place in this order
/// that has such a model. Among the models with this id and major version in all places, htex uses
/// the newest.
#[derive(Args)]
pub(crate) struct List {
    #[command(flatten)]
    plugins: PluginArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl List {
    pub(crate) fn run(self) -> Result {
        show(&ModelList(self.plugins.registry_quietly()?), self.json)
    }
}

/// The models that were found.
struct ModelList(Registry);

impl Serialize for ModelList {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let models = self.0.models().iter().map(|model| {
            let descriptor = model.descriptor();
            json!({
                "id": descriptor.id,
                "name": descriptor.name,
                "version": descriptor.version,
                "origin": model.origin().to_string(),
            })
        });
        let models: Vec<Value> = models.collect();
        let notes: Vec<String> = self.0.notes().iter().map(ToString::to_string).collect();
        json!({ "models": models, "notes": notes }).serialize(serializer)
    }
}

impl Display for ModelList {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        for model in self.0.models() {
            let (name, version) = (model.short_name(), &model.descriptor().version);
            writeln!(f, "  {name:12} {version:8} {:28} {}", model.id(), model.origin())?;
        }
        let mut notes = self.0.notes().iter();
        notes.try_for_each(|note| writeln!(f, "note: {}", plain(&note.to_string())))
    }
}
