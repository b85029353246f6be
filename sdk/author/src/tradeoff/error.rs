//! Errors of a sweep.

use std::path::PathBuf;

use htex_base::finding::Hint;

/// Why a sweep ended early. Points that were finished are in its journal.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TradeoffError {
    /// A recording cannot be used, or a model failed.
    #[error(transparent)]
    Author(#[from] crate::AuthorError),
    /// A model refused a setting.
    #[error(transparent)]
    Model(#[from] htex_host::HostError),
    /// Parameters cannot be stored in the chosen way.
    #[error(transparent)]
    Store(#[from] htex_format::WriteError),
    /// The journal could not be written.
    #[error("cannot keep finished points in {path}: {error}")]
    Journal { path: PathBuf, error: std::io::Error },
    /// Nothing can be held out of a recording.
    #[error("{recording}: {reason}, so that nothing can be held out: record for 10 s")]
    NothingHeldOut { recording: String, reason: &'static str },
    /// A knob does not have this value.
    #[error("knob {name}: `{value}` is not one of its values")]
    Knob { name: String, value: String },
}

impl TradeoffError {
    pub fn hint(&self) -> Hint {
        match self {
            Self::Author(error) => error.hint(),
            _ => Hint::NONE,
        }
    }
}
