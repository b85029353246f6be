//! Why there is no sweep.

use std::path::PathBuf;

/// Why a sweep ended early; what was finished is in its journal.
#[derive(Debug, thiserror::Error)]
pub enum TradeoffError {
    /// A recording is of no use, or a model failed.
    #[error(transparent)]
    Author(#[from] htex_author::AuthorError),
    /// A model refused a setting.
    #[error(transparent)]
    Model(#[from] htex_host::HostError),
    /// Parameters do not fit their store.
    #[error(transparent)]
    Store(#[from] htex_format::WriteError),
    /// The file of finished points could not be kept.
    #[error("cannot keep finished points in {path}: {error}")]
    Journal {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        error: std::io::Error,
    },
    /// A value that a knob does not take.
    #[error("knob {name}: `{value}` is none of its values")]
    Knob {
        /// The knob.
        name: String,
        /// What was given.
        value: String,
    },
}
