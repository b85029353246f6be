//! Arguments for finding models, shared by several commands.

use std::path::{Path, PathBuf};

use clap::Args;
use htex_format::Asset;
use htex_format::signing::Signers;
use htex_host::{LoadedModel, Origin, Registry, Search, WasmLimits};

use crate::failure::{Result, for_file};
use crate::output::warn;
use crate::signers::SignerArgs;
use crate::wasm_limits::WasmLimit;

/// Options that set where htex searches for models.
#[derive(Args)]
#[command(next_help_heading = "Models")]
pub(crate) struct PluginArgs {
    /// Load the model in this plugin; may be given several times. A WASM module runs in a sandbox.
    /// A native library runs with all your rights, so load only a library that you trust
    #[arg(long, value_name = "FILE")]
    plugin: Vec<PathBuf>,

    /// Search this folder for plugins, before the folders in HTEX_PLUGIN_PATH and the user's own
    /// folder; may be given several times
    #[arg(long, value_name = "DIR")]
    plugin_dir: Vec<PathBuf>,

    /// Limit the time, memory and other resources of WASM models, e.g. memory-mib=128; may be given
    /// several times. The numbers in square brackets are the defaults. Limits of each model:
    /// memory-mib (memory of one instance) [64], stack-kib [256], call-ms (time of one call that
    /// does not render) [5000], render-ms (time to render 8192 samples, or of one retune) [500],
    /// voices [256], table-elements [10000], module-mib (size of the module) [16], fuel
    /// (instructions in one call) [no limit], compile-ms (time to compile the module) [5000],
    /// compile-mib (memory to compile the module) [512]. Limits on the sum over all models of one
    /// asset: asset-ms (time for compiling and for all calls except calls to voices) [10000],
    /// asset-mib (memory) [512], asset-instances [512]. Limits on the sum over all models in one
    /// command: all-ms [30000], all-mib [1024], all-instances [2048]
    #[arg(long, value_name = "NAME=N", value_parser = WasmLimit::parse)]
    wasm_limit: Vec<WasmLimit>,
}

impl PluginArgs {
    /// Returns the plugin files that the user named.
    pub(crate) fn files(&self) -> &[PathBuf] {
        &self.plugin
    }

    /// Returns the models that are found. Prints the notes of the search as warnings, e.g. that a
    /// model shadows another one.
    pub(crate) fn registry(&self) -> Result<Registry> {
        self.registry_with(&[])
    }

    /// Returns the models as [`Self::registry`] does, with additional plugin files.
    pub(crate) fn registry_with(&self, files: &[PathBuf]) -> Result<Registry> {
        let registry = self.search(files)?;
        let notes: Vec<String> = registry.notes().iter().map(ToString::to_string).collect();
        warn(&notes);
        Ok(registry)
    }

    /// Returns the models as [`Self::registry`] does, but prints nothing.
    pub(crate) fn registry_quietly(&self) -> Result<Registry> {
        self.search(&[])
    }

    /// Returns the models without loading the native libraries in folders. The models in these
    /// libraries can only be listed. Prints nothing.
    pub(crate) fn described(&self) -> Result<Registry> {
        Ok(Registry::search(&self.places(&[]).with_only_descriptors(true))?)
    }

    /// Returns the model in the file of this name, if there is such a file, else the model with
    /// this short name or id.
    pub(crate) fn find(&self, name: &str) -> Result<LoadedModel> {
        let file = Path::new(name);
        if file.is_file() {
            return Ok(LoadedModel::from_file_within(file, &self.limits())?);
        }
        Ok(self.registry()?.find(name)?.clone())
    }

    pub(crate) fn limits(&self) -> WasmLimits {
        WasmLimit::all(&self.wasm_limit)
    }

    fn search(&self, files: &[PathBuf]) -> Result<Registry> {
        Ok(Registry::search(&self.places(files))?)
    }

    fn places(&self, files: &[PathBuf]) -> Search {
        Search::default()
            .with_files([&self.plugin[..], files].concat())
            .with_dirs(self.plugin_dir.clone())
            .with_limits(self.limits())
    }
}

/// Options for the models that play an asset: where htex searches for models, and whether it runs
/// the models that the asset embeds.
#[derive(Args)]
pub(crate) struct PlayerArgs {
    #[command(flatten)]
    plugins: PluginArgs,

    /// Do not run models that are embedded in the asset. By default, they run in a sandbox
    #[arg(long)]
    no_embedded_plugins: bool,

    #[command(flatten)]
    signers: SignerArgs,
}

impl PlayerArgs {
    /// Returns the models that are found, without the models embedded in assets.
    pub(crate) fn registry(&self) -> Result<Registry> {
        self.plugins.registry()
    }

    /// Whether embedded models may run.
    pub(crate) fn embedded(&self) -> bool {
        !self.no_embedded_plugins
    }

    /// Returns who must have signed each texture; `None` if signatures are not required.
    pub(crate) fn signers(&self) -> Result<Option<Signers>> {
        self.signers.signers()
    }

    /// Reads an asset, if it is signed as required.
    pub(crate) fn read(&self, path: &Path) -> Result<Asset> {
        let read = match self.signers()? {
            None => Asset::open(path),
            Some(signers) => Asset::open_signed(path, &signers),
        };
        read.map_err(for_file(path))
    }

    pub(crate) fn open(&self, path: &Path) -> Result<htex::Texture> {
        let registry = self.plugins.registry()?;
        let data = self.read(path)?;
        let asset = htex::Texture::with_registry(data, registry);
        if self.no_embedded_plugins {
            return Ok(asset);
        }
        Ok(asset.with_embedded())
    }
}

/// Returns how a model was loaded: a number for sorting, and a name. The built-in model comes
/// first, because the others are compared with it.
pub(crate) fn way(origin: &Origin) -> (u8, &'static str) {
    match origin {
        Origin::Builtin => (0, "built in"),
        Origin::Native(_) => (1, "native"),
        _ => (2, "wasm"),
    }
}
