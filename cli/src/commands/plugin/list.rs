use std::fmt::{Display, Formatter};

use clap::Args;
use htex_base::finding::plain;
use htex_host::{LoadedModel, Origin, Registry};
use serde::Serialize;

use crate::failure::Result;
use crate::keys::Signer;
use crate::output::show;
use crate::plugins::PluginArgs;

/// List all models, and the plugins that htex found but does not use.
///
/// htex searches for models in this order: --plugin, --plugin-dir, the folders in HTEX_PLUGIN_PATH,
/// the user's folder (`~/.local/share/htex/plugins`), the folders of all users
/// (`/usr/local/share/htex/plugins`, `/usr/share/htex/plugins`), the models built into this
/// program.
///
/// If several models have the same id, and --plugin names at least one of them, htex uses the first
/// that it names. If --plugin names none of them, htex goes through the places in the order above.
/// The first place that contains a model with this id determines the major version. htex then uses
/// the newest of the models with this id and major version in all places.
///
/// The command does not load the native libraries that it finds in these folders. Instead, it reads
/// the descriptors inside WASM modules, and the descriptor files beside native libraries (`htex
/// plugin export`).
#[derive(Args)]
pub(crate) struct List {
    #[command(flatten)]
    plugins: PluginArgs,

    /// Also say which plugins each model hides, and why
    #[arg(long)]
    why: bool,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl List {
    pub(crate) fn run(self) -> Result {
        let registry = self.plugins.described()?;
        let models = registry.models().iter().map(|model| ListedModel::new(&registry, model));
        let models: Result<Vec<ListedModel>> = models.collect();
        let notes = registry.notes().iter().map(ToString::to_string).collect();
        show(&ModelList { models: models?, notes, why: self.why }, self.json)
    }
}

/// The models that were found.
#[derive(Serialize)]
struct ModelList {
    models: Vec<ListedModel>,
    notes: Vec<String>,
    #[serde(skip)]
    why: bool,
}

#[derive(Serialize)]
struct ListedModel {
    id: String,
    #[serde(skip)]
    short_name: String,
    name: String,
    version: String,
    origin: String,
    /// Who signed the plugin; left out if nobody did.
    #[serde(skip_serializing_if = "Option::is_none")]
    signer: Option<Signer>,
    /// Models with the same id that are used only if their version is asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    hides: Vec<HiddenModel>,
}

#[derive(Serialize)]
struct HiddenModel {
    version: String,
    origin: String,
    why: &'static str,
}

impl ListedModel {
    fn new(registry: &Registry, model: &LoadedModel) -> Result<Self> {
        let descriptor = model.descriptor();
        let signer = match model.origin() {
            Origin::Native(file) | Origin::Wasm(file) => Signer::of_plugin(file)?,
            _ => None,
        };
        let hidden = registry.all(model.id()).skip(1).map(|hidden| HiddenModel {
            version: hidden.descriptor().version.clone(),
            origin: hidden.origin().to_string(),
            why: why(&descriptor.version, &hidden.descriptor().version),
        });
        Ok(Self {
            id: descriptor.id.clone(),
            short_name: model.short_name().to_owned(),
            name: descriptor.name.clone(),
            version: descriptor.version.clone(),
            origin: model.origin().to_string(),
            signer,
            hides: hidden.collect(),
        })
    }
}

/// Says why a version is used in place of another one.
fn why(used: &str, hidden: &str) -> &'static str {
    let numbers = |version: &str| semver::Version::parse(version).ok();
    match (numbers(used), numbers(hidden)) {
        (Some(used), Some(hidden)) if used.major != hidden.major => {
            "another major version, in a later place"
        }
        (Some(used), Some(hidden)) if used > hidden => "an older version",
        (Some(used), Some(hidden)) if used < hidden => {
            "a newer version, but the other one was named by its file"
        }
        _ => "the same version, in a later place",
    }
}

impl Display for ModelList {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        for model in &self.models {
            let ListedModel { id, short_name, version, origin, signer, hides, .. } = model;
            write!(f, "  {short_name:12} {version:8} {id:28} {origin}")?;
            if let Some(signer) = signer {
                write!(f, "  {}", plain(&signer.to_string()))?;
            }
            writeln!(f)?;
            for hidden in hides.iter().filter(|_| self.why) {
                let HiddenModel { version, origin, why } = hidden;
                writeln!(f, "  {:12} hides {version} ({origin}): {why}", "")?;
            }
        }
        let mut notes = self.notes.iter();
        notes.try_for_each(|note| writeln!(f, "note: {}", plain(note)))
    }
}
