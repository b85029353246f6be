//! Errors of a build.

use std::path::{Path, PathBuf};

/// An error that stops a build. Nothing that was there is lost, and what was fitted is kept for the next build.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The recipe is not TOML, or not a recipe.
    #[error("{problem}")]
    Recipe {
        /// What is wrong, and where.
        problem: String,
    },
    /// The recipe cannot be carried out.
    #[error("{place}: {problem}")]
    Plan {
        /// The part of the recipe.
        place: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// A file cannot be read.
    #[error("cannot read {file}: {error}")]
    Read {
        file: PathBuf,
        error: std::io::Error,
    },
    /// A file cannot be written.
    #[error("cannot write {file}: {error}")]
    Write {
        file: PathBuf,
        error: std::io::Error,
    },
    /// A file elsewhere cannot be read or written.
    #[error(transparent)]
    Storage(#[from] htex_storage::StorageError),
    /// Another build uses the folder.
    #[error("{folder}: another build is writing to it; wait for it to end, or give another folder")]
    Locked { folder: PathBuf },
    /// A texture cannot be made.
    #[error("{texture}: {problem}")]
    Texture {
        texture: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// The library cannot be written.
    #[error("{file}: {error}")]
    Library {
        file: PathBuf,
        error: htex_library::LibraryError,
    },
    /// The result of a job is damaged.
    #[error("the result of a job is damaged ({problem}); make it again")]
    Damaged {
        /// What is wrong with it.
        problem: String,
    },
    /// The build was stopped.
    #[error("stopped; what was fitted is kept, and the next build goes on from there")]
    Stopped,
}

impl BuildError {
    pub(crate) fn read(file: &Path, error: std::io::Error) -> Self {
        let file = file.to_owned();
        Self::Read { file, error }
    }

    pub(crate) fn write(file: &Path, error: std::io::Error) -> Self {
        let file = file.to_owned();
        Self::Write { file, error }
    }

    pub(crate) fn plan(place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Plan {
            place: place.into(),
            problem: problem.into(),
        }
    }
}
