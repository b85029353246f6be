//! Converts errors of the libraries to failures of the command.

use std::fmt::Display;
use std::path::Path;

use htex_base::files::FileError;
use htex_format::library::LibraryError;
use htex_scene::SceneError;

use crate::failure::Failure;
use crate::shown::shown;

/// An error that does not know its file.
pub(crate) trait OfFile {
    /// Converts the error to a failure that names the file.
    fn of(self, file: &Path) -> Failure;
}

impl OfFile for htex::Error {
    fn of(self, file: &Path) -> Failure {
        match self {
            Self::BakeRate { .. } => Failure::Usage(format!("--rate {self}")),
            Self::Axis { .. } | Self::Incomplete { .. } => {
                Failure::Usage(format!("--at, --grid: {self}"))
            }
            error => Failure::Asset { file: shown(file), error },
        }
    }
}

impl OfFile for htex_format::ReadError {
    fn of(self, file: &Path) -> Failure {
        htex::Error::from(self).of(file)
    }
}

impl OfFile for LibraryError {
    fn of(self, file: &Path) -> Failure {
        match self {
            Self::Open { path, error } => FileError::reading(path, error).into(),
            Self::Write { path, error } => FileError::writing(path, error).into(),
            Self::Storage(error) => error.into(),
            Self::Asset { error, .. } => error.of(file),
            error => Failure::Library { file: shown(file), error },
        }
    }
}

impl OfFile for SceneError {
    fn of(self, file: &Path) -> Failure {
        match self {
            Self::Io { path, error } => FileError::reading(path, error).into(),
            Self::Invalid { findings } => Failure::Findings {
                file: shown(file),
                cannot: "this scene cannot be played",
                findings,
            },
            error => Failure::Scene { file: shown(file), error: Box::new(error) },
        }
    }
}

#[cfg(feature = "build")]
impl OfFile for htex_build::BuildError {
    fn of(self, recipe: &Path) -> Failure {
        match self {
            Self::File(error) => error.into(),
            Self::Storage(error) => error.into(),
            error => Failure::Build { recipe: shown(recipe), error },
        }
    }
}

/// Adds the file's name to an error.
pub(crate) fn of_file<E: OfFile>(file: &Path) -> impl FnOnce(E) -> Failure {
    move |error| error.of(file)
}

impl Failure {
    /// Reports that the command line is invalid.
    pub(crate) fn usage(error: impl Display) -> Self {
        Self::Usage(error.to_string())
    }

    /// Reports an error that has no variant of its own.
    pub(crate) fn other(error: impl Display) -> Self {
        Self::Other(error.to_string())
    }
}
