//! What a program's user should know of the models that were found.

use std::path::PathBuf;

use crate::{HostError, Origin};

/// What happened while models were looked for, and is no reason to stop.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Note {
    /// Two models have the same id; the one found first is used.
    Shadowed {
        /// The id.
        id: String,
        /// The model that is used: its version, and where it comes from.
        used: (String, Origin),
        /// The model that is used only when its version is asked for.
        shadowed: (String, Origin),
    },
    /// Two models of different ids have the same short name, which means the one found first.
    SameName {
        /// The short name.
        name: String,
        /// The id it means.
        means: String,
        /// The id that must be written out.
        other: String,
    },
    /// A file in a plugin folder could not be loaded.
    Broken {
        /// The file.
        path: PathBuf,
        /// Why not.
        error: HostError,
    },
    /// A folder of `HTEX_PLUGIN_PATH`, or the user's, could not be read.
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why not.
        what: String,
    },
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shadowed { id, used, shadowed } => write!(
                f,
                "{id} {} ({}) is used in place of {} ({})",
                used.0, used.1, shadowed.0, shadowed.1
            ),
            Self::SameName { name, means, other } => write!(
                f,
                "`{name}` means {means}; write `{other}` in full for the other one"
            ),
            Self::Broken { path, error } => {
                write!(f, "plugin {} is left out: {error}", path.display())
            }
            Self::Folder { path, what } => {
                write!(f, "plugin folder {}: {what}", path.display())
            }
        }
    }
}
