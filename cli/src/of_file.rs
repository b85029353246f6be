//! Converts errors of the libraries to failures of the command.

use std::fmt::Display;
use std::path::Path;

use htex_base::files::FileError;
use htex_format::library::LibraryError;
use htex_scene::{LoadError, SceneError};

use crate::failure::Failure;
use crate::shown::shown;

/// An error that does not know its file.
pub(crate) trait OfFile {
    /// Converts the error to a failure that names the file.
    fn of(self, file: &Path) -> Failure;
}

impl OfFile for htex::Error {
    fn of(self, file: &Path) -> Failure {
        Failure::Asset { file: shown(file), error: self }
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

impl OfFile for LoadError {
    fn of(self, file: &Path) -> Failure {
        match self {
            Self::Io { path, error } => FileError::reading(path, error).into(),
            Self::Invalid { findings } => Failure::Findings {
                file: shown(file),
                cannot: "this scene cannot be played",
                findings,
            },
            other => Failure::Other(format!("{}: {other}", shown(file))),
        }
    }
}

impl OfFile for SceneError {
    fn of(self, file: &Path) -> Failure {
        Failure::Scene { file: shown(file), error: Box::new(self) }
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

/// Adds the file's name to the error of a result.
pub(crate) trait ResultOfFile<T> {
    fn of(self, file: &Path) -> Result<T, Failure>;
}

impl<T, E: OfFile> ResultOfFile<T> for Result<T, E> {
    fn of(self, file: &Path) -> Result<T, Failure> {
        self.map_err(|error| error.of(file))
    }
}

/// Converts the text of an error to a failure.
pub(crate) trait OrFail<T> {
    /// Reports that the command line is invalid.
    fn or_usage(self) -> Result<T, Failure>;
    /// Reports any other error.
    fn or_fail(self) -> Result<T, Failure>;
}

impl<T, E: Display> OrFail<T> for Result<T, E> {
    fn or_usage(self) -> Result<T, Failure> {
        self.map_err(|error| Failure::Usage(error.to_string()))
    }

    fn or_fail(self) -> Result<T, Failure> {
        self.map_err(|error| Failure::Other(error.to_string()))
    }
}
