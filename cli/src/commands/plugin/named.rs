//! Finds a model by its name or file.

use std::path::Path;

use htex_host::LoadedModel;

use crate::failure::Failure;
use crate::plugins::PluginArgs;

/// Returns the model in the file of this name if the file exists, else the model with this short
/// name or id.
pub(crate) fn named(name: &str, plugins: &PluginArgs) -> Result<LoadedModel, Failure> {
    let file = Path::new(name);
    if file.is_file() {
        return Ok(LoadedModel::from_file_within(file, &plugins.limits())?);
    }
    Ok(plugins.registry()?.find(name)?.clone())
}
