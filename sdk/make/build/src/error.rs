//! Errors of a build.

use std::fmt::Display;
use std::path::PathBuf;

/// Error that stops a build. Existing files are not lost, and finished fits are stored for the next
/// build.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The recipe is not TOML, or it is not a valid recipe. The text says what is wrong, and where.
    #[error("{0}")]
    Recipe(String),
    /// The recipe cannot be carried out.
    #[error("{place}: {problem}")]
    At {
        /// The part of the recipe, the texture, or the file.
        place: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] htex_base::files::FileError),
    /// A file on a web server or in an object store cannot be read or written.
    #[error(transparent)]
    Storage(#[from] htex_base::storage::StorageError),
    /// Another build is using the folder.
    #[error("{folder}: another build is writing to it; wait for it to end, or give another folder")]
    Locked { folder: PathBuf },
    /// The library would lose textures, and the options or the recipe forbid it. Nothing was
    /// changed.
    #[error(
        "the library would lose {} textures ({}); bring back their recordings, or allow removals",
        .textures.len(), crate::named_briefly(.textures)
    )]
    Removes { textures: Vec<String> },
    /// The result of a job is damaged. The text describes the damage.
    #[error("the result of a job is damaged ({0}); make it again")]
    Damaged(String),
    /// The build was stopped.
    #[error("stopped; what was fitted is kept, and the next build goes on from there")]
    Stopped,
}

impl BuildError {
    /// Returns an error if more than `most` textures would be removed.
    pub(crate) fn refuse_removals(textures: Vec<String>, most: usize) -> Result<(), Self> {
        if textures.len() <= most { Ok(()) } else { Err(Self::Removes { textures }) }
    }

    pub(crate) fn at_place(place: impl Display, problem: impl Display) -> Self {
        Self::At { place: place.to_string(), problem: problem.to_string() }
    }
}

impl From<serde_json::Error> for BuildError {
    fn from(error: serde_json::Error) -> Self {
        Self::Damaged(error.to_string())
    }
}

impl From<htex_base::files::toml::TomlError> for BuildError {
    fn from(error: htex_base::files::toml::TomlError) -> Self {
        Self::Recipe(error.to_string())
    }
}

/// Adds the part of the recipe, the texture or the file to an error.
pub(crate) fn at_place<E: Display>(place: impl Display) -> impl FnOnce(E) -> BuildError {
    move |error| BuildError::at_place(place, error)
}
