//! The places in which the host searches for models.

use std::path::{Path, PathBuf};

use htex_base::native::folders::{data, libraries_in, listed, system};

use crate::registry::Rank;
use crate::{HostError, LoadedModel, Note, Registry, WasmLimits};

/// Environment variable that lists the plugin folders, separated as in `PATH`.
const VARIABLE: &str = "HTEX_PLUGIN_PATH";
/// The user's plugin folder, relative to the data folder.
const FOLDER: &str = "htex/plugins";

/// The places to search for models, in order of precedence: `files`, `modules`, models embedded in
/// an asset, `dirs`, `HTEX_PLUGIN_PATH`, the user's folder, the folders of all users, built-in
/// models. In `dirs` and all places after it, a newer version takes precedence over an older
/// version with the same major version, even if the older version is in an earlier place
/// ([`Registry`]).
///
/// ```
/// use htex_host::{Registry, Search, WasmLimits};
/// let search = Search::builtin().with_limits(WasmLimits::default().with_voices(8));
/// let registry = Registry::search(&search)?;
/// assert!(registry.find("mfcc").is_ok());
/// # Ok::<(), htex_host::HostError>(())
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Search {
    /// Plugin files. A file that cannot be loaded is an error.
    pub files: Vec<PathBuf>,
    /// Module files that the user did not name, e.g. files named by a recipe. These files must be
    /// WASM modules, which run in a sandbox. Any other file is an error and is not loaded, because
    /// a native library runs with all the rights of its user. A user who wants a native library
    /// must name it in `files`, which takes precedence over `modules`.
    pub modules: Vec<PathBuf>,
    /// Plugin folders. A folder that cannot be read is an error. If a plugin in a folder cannot be
    /// loaded, this is not an error, but the registry gets a [`Note`].
    pub dirs: Vec<PathBuf>,
    /// Whether to search the folders in the variable `HTEX_PLUGIN_PATH`.
    pub env: bool,
    /// Whether to search `htex/plugins` in the user's data folder, and then in the folders of all
    /// users. The user's data folder is `$XDG_DATA_HOME`, or `~/.local/share` if this variable is
    /// not set. The folders of all users are in `$XDG_DATA_DIRS`, or `/usr/local/share` and
    /// `/usr/share`.
    pub user_dir: bool,
    /// Whether to include the models linked into this program.
    pub builtin: bool,
    /// Whether to read only the descriptors of plugins in folders. The search then loads no native
    /// library; a program can list the models that it found, but cannot call them.
    #[cfg(feature = "descriptions")]
    pub only_descriptors: bool,
    pub limits: WasmLimits,
}

impl Default for Search {
    /// All places except `files` and `dirs`.
    fn default() -> Self {
        Self {
            files: Vec::new(),
            modules: Vec::new(),
            dirs: Vec::new(),
            env: true,
            user_dir: true,
            builtin: true,
            #[cfg(feature = "descriptions")]
            only_descriptors: false,
            limits: WasmLimits::default(),
        }
    }
}

impl Search {
    /// Searches only the models linked into this program.
    pub fn builtin() -> Self {
        Self { env: false, user_dir: false, ..Self::default() }
    }

    htex_base::setters! {
        /// Sets the plugin files.
        with_files(files: Vec<PathBuf>);
        /// Sets the module files that the user did not name.
        with_modules(modules: Vec<PathBuf>);
        /// Sets the plugin folders.
        with_dirs(dirs: Vec<PathBuf>);
        /// Sets whether the folders in `HTEX_PLUGIN_PATH` are searched.
        with_env(env: bool);
        /// Sets whether the user's folder is searched.
        with_user_dir(user_dir: bool);
        /// Sets whether the models linked into this program are included.
        with_builtin(builtin: bool);
        with_limits(limits: WasmLimits);
    }

    /// Sets whether only the descriptors of plugins in folders are read.
    #[cfg(feature = "descriptions")]
    #[must_use]
    pub fn with_only_descriptors(self, only_descriptors: bool) -> Self {
        Self { only_descriptors, ..self }
    }

    /// See [`Registry::search`].
    pub(crate) fn run(&self) -> Result<Registry, HostError> {
        let mut registry = Registry::empty(&self.limits);
        for path in &self.files {
            let model = LoadedModel::from_file_in(path, registry.sandbox())?;
            registry.add(Rank::File, model);
        }
        for path in &self.modules {
            let model = LoadedModel::from_module_in(path, registry.sandbox())?;
            registry.add(Rank::File, model);
        }
        for dir in &self.dirs {
            let files =
                libraries_in(dir, Some("wasm")).map_err(HostError::loading(dir.display()))?;
            self.add_all(&mut registry, Rank::Folder, files);
        }
        if self.env {
            for dir in listed(VARIABLE) {
                self.add_folder(&mut registry, Rank::Folder, &dir);
            }
        }
        // A browser has no environment variables, so these are read only if folders are searched.
        if self.user_dir {
            if let Some(dir) = data(FOLDER) {
                self.add_folder(&mut registry, Rank::User, &dir);
            }
            for dir in system(FOLDER) {
                self.add_folder(&mut registry, Rank::System, &dir);
            }
        }
        if self.builtin {
            registry.add_builtin();
        }
        Ok(registry)
    }

    /// Adds the plugins of a folder that is not one of `dirs`. If the folder cannot be read, adds a
    /// note.
    fn add_folder(&self, registry: &mut Registry, rank: Rank, dir: &Path) {
        match libraries_in(dir, Some("wasm")) {
            Ok(files) => self.add_all(registry, rank, files),
            Err(error) => {
                registry.note(Note::Folder { path: dir.to_owned(), what: error.to_string() })
            }
        }
    }

    /// Loads a plugin of a folder. Returns `None` for a native library that must not be loaded and
    /// does not contain a descriptor.
    fn load(&self, path: &Path, registry: &Registry) -> Result<Option<LoadedModel>, HostError> {
        #[cfg(feature = "descriptions")]
        if self.only_descriptors {
            let described = crate::described::model(path)?;
            let is_module = path.extension().is_some_and(|extension| extension == "wasm");
            if described.is_some() || !is_module {
                return Ok(described);
            }
        }
        LoadedModel::from_file_in(path, registry.sandbox()).map(Some)
    }

    fn add_all(&self, registry: &mut Registry, rank: Rank, files: Vec<PathBuf>) {
        for path in files {
            match self.load(&path, registry) {
                Ok(Some(model)) => registry.add(rank, model),
                Ok(None) => registry.note(Note::Undescribed { path }),
                Err(error) => registry.note(Note::Broken { path, error }),
            }
        }
    }
}
