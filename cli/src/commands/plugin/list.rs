use clap::Args;
use htex_base::finding::plain;
use htex_host::Registry;
use serde_json::{Value, json};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::plugins::PluginArgs;

/// List all models found, and what was found but is not used.
///
/// Search order: --plugin, --plugin-dir, the folders in HTEX_PLUGIN_PATH, the user's folder, built
/// in. If two models have the same id, the first one given by --plugin is used, else the newest of
/// its major version, else the first one found.
#[derive(Args)]
pub(crate) struct List {
    #[command(flatten)]
    plugins: PluginArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl List {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let registry = self.plugins.registry_quietly()?;
        if self.json {
            print_json(&json(&registry))?;
        } else {
            print(&text(&registry))?;
        }
        Ok(Exit::SUCCESS)
    }
}

fn json(registry: &Registry) -> Value {
    let models = registry.models().iter().map(|model| {
        let descriptor = model.descriptor();
        json!({
            "id": descriptor.id,
            "name": descriptor.name,
            "version": descriptor.version,
            "origin": model.origin().to_string(),
        })
    });
    let models: Vec<Value> = models.collect();
    let notes: Vec<String> = registry.notes().iter().map(ToString::to_string).collect();
    json!({ "models": models, "notes": notes })
}

fn text(registry: &Registry) -> String {
    let mut text = String::new();
    for model in registry.models() {
        let (name, version) = (model.short_name(), &model.descriptor().version);
        text += &format!("  {name:12} {version:8} {:28} {}\n", model.id(), model.origin());
    }
    for note in registry.notes() {
        text += &format!("note: {}\n", plain(&note.to_string()));
    }
    text
}
