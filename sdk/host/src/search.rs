//! Where models are looked for.

use std::io;
use std::path::{Path, PathBuf};

use crate::registry::Rank;
use crate::{HostError, LoadedModel, Note, Registry, WasmLimits, folders};

/// Names plugin folders, as `PATH` names those of programs.
const VARIABLE: &str = "HTEX_PLUGIN_PATH";

/// Where models are looked for. What is found earlier goes before what is found later: `files`,
/// models embedded in an asset, `dirs`, `HTEX_PLUGIN_PATH`, the user's folder, built in.
#[derive(Debug, Clone)]
pub struct Search {
    /// Plugins by their files; one that cannot be loaded is an error.
    pub files: Vec<PathBuf>,
    /// Folders of plugins; one that cannot be read is an error, a plugin in it that cannot be
    /// loaded a [`Note`].
    pub dirs: Vec<PathBuf>,
    /// Whether to look into the folders that the variable `HTEX_PLUGIN_PATH` names.
    pub env: bool,
    /// Whether to look into `htex/plugins` in the user's data folder (`$XDG_DATA_HOME`, else
    /// `~/.local/share`).
    pub user_dir: bool,
    /// Whether to take the models linked into this program.
    pub builtin: bool,
    /// What a WASM model may use.
    pub limits: WasmLimits,
}

impl Default for Search {
    /// Everywhere, without files and folders of its own.
    fn default() -> Self {
        Self {
            files: Vec::new(),
            dirs: Vec::new(),
            env: true,
            user_dir: true,
            builtin: true,
            limits: WasmLimits::default(),
        }
    }
}

impl Search {
    /// The models linked into this program, and none else.
    pub fn builtin() -> Self {
        Self {
            env: false,
            user_dir: false,
            ..Self::default()
        }
    }

    /// See [`Registry::search`].
    pub(crate) fn run(&self) -> Result<Registry, HostError> {
        let mut registry = Registry::empty(&self.limits);
        for path in &self.files {
            let model = LoadedModel::from_file_in(path, registry.sandbox())?;
            registry.add(Rank::File, model);
        }
        for dir in &self.dirs {
            let files = plugins_in(dir).map_err(|e| HostError::Load {
                path: dir.display().to_string(),
                what: e.to_string(),
            })?;
            self.add_all(&mut registry, Rank::Folder, files);
        }
        if self.env {
            let value = std::env::var_os(VARIABLE).unwrap_or_default();
            for dir in std::env::split_paths(&value).filter(|dir| !dir.as_os_str().is_empty()) {
                self.add_folder(&mut registry, Rank::Folder, &dir);
            }
        }
        if let Some(dir) = folders::plugins().filter(|dir| self.user_dir && dir.exists()) {
            self.add_folder(&mut registry, Rank::User, &dir);
        }
        if self.builtin {
            registry.add_builtin();
        }
        Ok(registry)
    }

    /// Adds the plugins of a folder that nobody named in this search.
    fn add_folder(&self, registry: &mut Registry, rank: Rank, dir: &Path) {
        match plugins_in(dir) {
            Ok(files) => self.add_all(registry, rank, files),
            Err(error) => registry.note(Note::Folder {
                path: dir.to_owned(),
                what: error.to_string(),
            }),
        }
    }

    fn add_all(&self, registry: &mut Registry, rank: Rank, files: Vec<PathBuf>) {
        for path in files {
            match LoadedModel::from_file_in(&path, registry.sandbox()) {
                Ok(model) => registry.add(rank, model),
                Err(error) => registry.note(Note::Broken { path, error }),
            }
        }
    }
}

/// The plugins in a folder, by name.
fn plugins_in(dir: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(dir)? {
        let path = entry?.path();
        let extension = path.extension().and_then(|e| e.to_str());
        if extension == Some("wasm") || extension == Some(std::env::consts::DLL_EXTENSION) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
