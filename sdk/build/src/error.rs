//! Errors of a build.

use std::fmt::Display;
use std::path::PathBuf;

/// An error that stops a build. Nothing that was there is lost, and what was fitted is kept for the
/// next build.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The recipe is not TOML, or not a recipe: what is wrong, and where.
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
    File(#[from] htex_files::FileError),
    /// A file elsewhere cannot be read or written.
    #[error(transparent)]
    Storage(#[from] htex_storage::StorageError),
    /// Another build uses the folder.
    #[error("{folder}: another build is writing to it; wait for it to end, or give another folder")]
    Locked { folder: PathBuf },
    /// The library would lose textures, and the build keeps all. Nothing was changed.
    #[error(
        "the library would lose {} textures ({}); bring back their recordings, or allow removals",
        .textures.len(), crate::named_briefly(.textures)
    )]
    Removes { textures: Vec<String> },
    /// The result of a job is damaged: what is wrong with it.
    #[error("the result of a job is damaged ({0}); make it again")]
    Damaged(String),
    /// The build was stopped.
    #[error("stopped; what was fitted is kept, and the next build goes on from there")]
    Stopped,
}

impl BuildError {
    /// Refuses to remove textures; none is no error.
    pub(crate) fn refuse_removals(textures: Vec<String>) -> Result<(), Self> {
        if textures.is_empty() { Ok(()) } else { Err(Self::Removes { textures }) }
    }

    pub(crate) fn at(place: impl Display, problem: impl Display) -> Self {
        Self::At { place: place.to_string(), problem: problem.to_string() }
    }
}

impl From<serde_json::Error> for BuildError {
    fn from(error: serde_json::Error) -> Self {
        Self::Damaged(error.to_string())
    }
}

impl From<htex_files::toml::TomlError> for BuildError {
    fn from(error: htex_files::toml::TomlError) -> Self {
        Self::Recipe(error.to_string())
    }
}

/// Adds to an error where it is.
pub(crate) trait AtPlace<T> {
    /// In this part of the recipe, texture or file.
    fn at(self, place: impl Display) -> Result<T, BuildError>;
}

impl<T, E: Display> AtPlace<T> for Result<T, E> {
    fn at(self, place: impl Display) -> Result<T, BuildError> {
        self.map_err(|error| BuildError::at(place, error))
    }
}
