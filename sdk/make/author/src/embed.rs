//! Embeds the WASM modules of models into an asset.

use std::path::{Path, PathBuf};

use htex_format::signing::SecretKey;
use htex_format::{Asset, Plugin};
use htex_host::{LoadedModel, Origin, Registry};

use crate::AuthorError;

/// Embeds the WASM modules of fitted models into an asset. If a key is given, signs each module.
/// `registry` must have loaded the models from these same `files`.
///
/// # Errors
/// See [`AuthorError`].
pub fn embed_plugins(
    asset: &mut Asset,
    registry: &Registry,
    files: &[PathBuf],
    secret_key: Option<&SecretKey>,
) -> Result<(), AuthorError> {
    for file in files {
        let model = model_of(registry, file)?;
        let representations = &asset.manifest.representations;
        if !representations.iter().any(|r| r.model == model.id()) {
            return Err(AuthorError::ModuleNotFitted {
                file: file.clone(),
                model: model.id().to_owned(),
            });
        }
        let module = std::fs::read(file)
            .map_err(|error| AuthorError::Module { file: file.clone(), error })?;
        let plugin = Plugin::new(model.id(), &model.descriptor().version, &module);
        asset.manifest.plugins.push(match secret_key {
            Some(key) => plugin.signed(key),
            None => plugin,
        });
        asset.plugins.push(module);
    }
    Ok(())
}

/// Returns the model that was loaded from a module file.
fn model_of<'a>(registry: &'a Registry, file: &Path) -> Result<&'a LoadedModel, AuthorError> {
    let of_file = |m: &&LoadedModel| matches!(m.origin(), Origin::Wasm(path) if path == file);
    let model = registry.models().iter().find(of_file);
    model.ok_or_else(|| AuthorError::NoModule { file: file.to_owned() })
}
