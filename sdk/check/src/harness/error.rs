//! The error of the checkers and the benchmark.

use std::path::PathBuf;

use thiserror::Error;

/// An error that prevents the checks from running, or the benchmark from measuring a model.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The table has no check of this name.
    #[error("there is no check `{name}`; there are {}", known.join(", "))]
    Unknown {
        name: String,
        /// The names of all checks in the table.
        known: Vec<&'static str>,
    },
    /// The model cannot be read.
    #[error("{}: {error}", path.display())]
    File { path: PathBuf, error: std::io::Error },
    /// A model cannot be fitted, or fails to render.
    #[error("{model} ({way}): {what}")]
    Model {
        /// The model's short name.
        model: String,
        /// How the model was loaded.
        way: String,
        what: String,
    },
}
