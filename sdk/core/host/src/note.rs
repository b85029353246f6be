//! Notes on the models that a search found.

use std::path::PathBuf;

use crate::{HostError, Origin};

/// A note for the user about a problem during a search for models. The search continued after the
/// problem.
///
/// ```
/// use htex_host::{Note, Registry, Search};
/// let registry = Registry::search(&Search::default())?;
/// for note in registry.notes() {
///     if let Note::Broken { path, .. } = note {
///         eprintln!("remove or update {}", path.display());
///     }
///     eprintln!("{note}");
/// }
/// # Ok::<(), htex_host::HostError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// Two models have the same id. The rules of [`Registry`](crate::Registry) decide which one is
    /// used.
    Shadowed {
        id: String,
        /// Version and origin of the model that is used.
        used: (String, Origin),
        /// Version and origin of the other model. It is used only if its version is requested.
        shadowed: (String, Origin),
    },
    /// Two models with different ids have the same short name. The name refers to the model that
    /// was found first.
    SameName {
        /// The short name.
        name: String,
        /// The id of the model to which the short name refers.
        means: String,
        /// The id of the other model. The user has to write this id in full.
        other: String,
    },
    /// A file in a plugin folder could not be loaded.
    Broken { path: PathBuf, error: HostError },
    /// A plugin folder contains a native library whose model the host cannot list, because only the
    /// library's own code could return the model's descriptor.
    Undescribed { path: PathBuf },
    /// A folder of `HTEX_PLUGIN_PATH`, or the user's plugin folder, could not be read.
    Folder { path: PathBuf, what: String },
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shadowed { id, used, shadowed } => write!(
                f,
                "{id} {} ({}) is used in place of {} ({})",
                used.0, used.1, shadowed.0, shadowed.1
            ),
            Self::SameName { name, means, other } => {
                write!(f, "`{name}` means {means}; write `{other}` in full for the other one")
            }
            Self::Broken { path, error } => {
                write!(f, "plugin {} is left out: {error}", path.display())
            }
            Self::Undescribed { path } => {
                let path = path.display();
                write!(
                    f,
                    "plugin {path} was not loaded, and no descriptor is beside it; `htex plugin export {path}` writes one"
                )
            }
            Self::Folder { path, what } => {
                write!(f, "plugin folder {}: {what}", path.display())
            }
        }
    }
}
