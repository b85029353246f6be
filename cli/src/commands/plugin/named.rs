//! A model by name or file.

use std::path::Path;

use htex_host::{LoadedModel, Registry};

use crate::failure::Failure;

/// The model in a file, when there is one of this name; else the model of this short name or id.
pub(crate) fn named(name: &str) -> Result<LoadedModel, Failure> {
    let file = Path::new(name);
    if file.is_file() {
        return Ok(LoadedModel::from_file(file)?);
    }
    Ok(Registry::builtin().find(name)?.clone())
}
