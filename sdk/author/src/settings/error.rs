//! Errors of settings.

use htex_host::HostError;

use crate::AuthorError;
use htex_recording::ReadError;

/// Why settings cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// A map of columns cannot be read.
    #[error("{keyword} {text}: {error}")]
    Map {
        /// Its name: `map` or `tracker_map`.
        keyword: &'static str,
        text: String,
        /// What is wrong with it.
        error: Box<ReadError>,
    },
    /// The number of trackers is neither one nor the number of recordings.
    #[error("{trackers} trackers for {recordings} recordings; give one for each, or one for all")]
    Trackers {
        /// Number of trackers that are given.
        trackers: usize,
        recordings: usize,
    },
    /// The response of the recording setup cannot be read.
    #[error(transparent)]
    Response(Box<ReadError>),
    /// A model or one of its options is unknown.
    #[error(transparent)]
    Model(#[from] HostError),
    /// An option names a model that is not being fitted.
    #[error("option {model}.{name}: no such model is fitted; there are {}", .fitted.join(", "))]
    ModelNotFitted {
        /// The model that the option names.
        model: String,
        name: String,
        /// Short names of the models that are being fitted.
        fitted: Vec<String>,
    },
    /// An option is not of the form `MODEL.NAME=VALUE`.
    #[error("option {text}: it looks like MODEL.NAME=VALUE, e.g. ar.order=6")]
    OptionForm { text: String },
    /// The grid cannot be read.
    #[error(transparent)]
    Grid(Box<AuthorError>),
    /// Metadata that asset validation would reject.
    #[error("{field}: {problem}")]
    Metadata {
        field: &'static str,
        /// What is wrong with it, and what to do.
        problem: String,
    },
}
