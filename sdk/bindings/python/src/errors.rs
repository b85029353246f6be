//! Converts errors to the package's exceptions.

use std::io;
use std::path::Path;

use htex::format::{ReadError, WriteError};
use htex::model::HostError;
use htex::play::ErrorKind;
use htex_author::recording::{ReadError as RecordingReadError, ReadProblem};
use htex_author::{AuthorError, AuthorErrorKind};
use htex_scene::SceneError as PlayError;
use pyo3::exceptions::PyOSError;
use pyo3::import_exception;
use pyo3::prelude::*;

use crate::causes;

import_exception!(htex._errors, AssetError);
import_exception!(htex._errors, BuildError);
import_exception!(htex._errors, DeviceError);
import_exception!(htex._errors, ExchangeError);
import_exception!(htex._errors, LibraryError);
import_exception!(htex._errors, ModelError);
import_exception!(htex._errors, MotionError);
import_exception!(htex._errors, OptionError);
import_exception!(htex._errors, RecordingError);
import_exception!(htex._errors, SceneError);
import_exception!(htex._errors, SignatureError);

/// An error that becomes an exception of this package, or an `OSError` if the operating system
/// reported it.
pub(crate) trait IntoPyErr {
    /// Converts the error to an exception.
    fn into_py_err(self) -> PyErr;
}

/// Converts an error to an exception.
pub(crate) fn raised(error: impl IntoPyErr) -> PyErr {
    causes::attach(error.into_py_err())
}

/// Makes the `OSError` for a file. The system's error number determines the subclass, such as
/// `FileNotFoundError`.
pub(crate) fn of_file(path: &Path, error: &io::Error) -> PyErr {
    match error.raw_os_error() {
        Some(number) => {
            let text = error.to_string();
            // Python adds the error number to the text itself.
            let text = text.split(" (os error").next().unwrap_or_default();
            let file = path.as_os_str().to_owned();
            PyOSError::new_err((number, text.to_owned(), file))
        }
        None => io::Error::new(error.kind(), format!("{}: {error}", path.display())).into(),
    }
}

/// Makes the exception for an invalid argument.
pub(crate) fn option(text: impl Into<String>) -> PyErr {
    OptionError::new_err(text.into())
}

impl IntoPyErr for ReadError {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::Io { path, error } => of_file(&path, &error),
            Self::Signature(_) => SignatureError::new_err(self.to_string()),
            other => AssetError::new_err(other.to_string()),
        }
    }
}

impl IntoPyErr for WriteError {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::Io { path, error } => of_file(&path, &error),
            other => AssetError::new_err(other.to_string()),
        }
    }
}

impl IntoPyErr for HostError {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::UnknownOption { .. }
            | Self::OptionValue { .. }
            | Self::Synthesis { .. }
            | Self::Rates { .. } => option(self.to_string()),
            other => ModelError::new_err(other.to_string()),
        }
    }
}

impl IntoPyErr for htex::Error {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::Read(error) => error.into_py_err(),
            Self::Model(error) => error.into_py_err(),
            Self::Library(error) => error.into_py_err(),
            Self::Fields { .. } => AssetError::new_err(self.to_string()),
            error => match error.kind() {
                ErrorKind::Motion => MotionError::new_err(error.to_string()),
                ErrorKind::Option => option(error.to_string()),
                _ => ModelError::new_err(error.to_string()),
            },
        }
    }
}

impl IntoPyErr for RecordingReadError {
    fn into_py_err(self) -> PyErr {
        match &self.problem {
            ReadProblem::Io(error) => of_file(Path::new(&self.file), error),
            ReadProblem::Option { .. } | ReadProblem::NoRate => option(self.to_string()),
            _ => RecordingError::new_err(self.to_string()),
        }
    }
}

impl IntoPyErr for AuthorError {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::Model(error) => error.into_py_err(),
            Self::Read(error) => error.into_py_err(),
            Self::Asset(error) => error.into_py_err(),
            Self::ReadAsset(error) => error.into_py_err(),
            Self::Play(error) => error.into_py_err(),
            Self::Module { file: path, error } | Self::Journal { path, error } => {
                of_file(&path, &error)
            }
            Self::OtherQuantity { held, .. } => {
                option(format!("{self}; give quantity=\"{}\"", held.name()))
            }
            other => match other.kind() {
                AuthorErrorKind::Model => ModelError::new_err(other.to_string()),
                AuthorErrorKind::Asset => AssetError::new_err(other.to_string()),
                AuthorErrorKind::Recording => RecordingError::new_err(other.to_string()),
                _ => option(other.to_string()),
            },
        }
    }
}

impl IntoPyErr for PlayError {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::Io { path, error } => of_file(&path, &error),
            Self::Motion { .. } => MotionError::new_err(self.to_string()),
            Self::Unsigned { .. } => SignatureError::new_err(self.to_string()),
            other => SceneError::new_err(other.to_string()),
        }
    }
}

impl IntoPyErr for htex_device::DeviceError {
    fn into_py_err(self) -> PyErr {
        SceneError::new_err(self.to_string())
    }
}
