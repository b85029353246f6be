//! Searches for models, and describes the models found.

use std::path::PathBuf;

use htex::model::{Registry, Search};
use pyo3::prelude::*;

use crate::errors::raised;
use crate::python::from_json;
use crate::python_model;

/// Searches for models. Finds the models in plugin files and folders, the built-in models, the
/// models written in Python and, if requested, the installed models.
pub(crate) fn registry(plugins: &[PathBuf], installed: bool) -> PyResult<Registry> {
    let (dirs, files) = plugins.iter().cloned().partition(|path| path.is_dir());
    let places = Search::builtin().with_env(installed).with_user_dir(installed);
    let mut registry =
        Registry::search(&places.with_files(files).with_dirs(dirs)).map_err(raised)?;
    python_model::add_to(&mut registry)?;
    Ok(registry)
}

/// Returns the descriptors of the models that were found.
#[pyfunction]
#[pyo3(signature = (*, plugins=Vec::new(), installed=false))]
pub(crate) fn models(
    py: Python<'_>,
    plugins: Vec<PathBuf>,
    installed: bool,
) -> PyResult<Bound<'_, PyAny>> {
    let registry = py.detach(|| registry(&plugins, installed))?;
    let descriptors: Vec<_> = registry.models().iter().map(|m| m.descriptor()).collect();
    from_json(py, &descriptors)
}
