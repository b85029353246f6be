//! Errors of the functions that make textures.

use htex_author::recording::{ReadError, ReadProblem};
use htex_author::{AuthorError, AuthorErrorKind};
use htex_c::htex_status::*;
use htex_format::library::LibraryError;
use htex_format::{MetadataError, ReadError as AssetError, WriteError};

use crate::refusal::Refusal;

impl Refusal {
    fn recording(error: impl ToString) -> Self {
        Self::new(HTEX_STATUS_INVALID_ARGUMENT, "invalid-recording", error)
    }

    fn asset(error: impl ToString) -> Self {
        Self::new(HTEX_STATUS_INVALID_ASSET, "invalid-asset", error)
    }
}

impl From<ReadError> for Refusal {
    fn from(error: ReadError) -> Self {
        match error.problem {
            ReadProblem::Option { .. } | ReadProblem::NoRate => Self::argument(error),
            _ => Self::recording(error),
        }
    }
}

impl From<AuthorError> for Refusal {
    fn from(error: AuthorError) -> Self {
        match error {
            AuthorError::Model(error) => error.into(),
            AuthorError::Read(error) => error.into(),
            AuthorError::Play(_) => Self::argument(error),
            other => match other.kind() {
                AuthorErrorKind::Model => Self::model(other),
                AuthorErrorKind::Asset => Self::asset(other),
                AuthorErrorKind::Recording => Self::recording(other),
                _ => Self::argument(other),
            },
        }
    }
}

impl From<AssetError> for Refusal {
    fn from(error: AssetError) -> Self {
        Self::asset(error)
    }
}

impl From<MetadataError> for Refusal {
    fn from(error: MetadataError) -> Self {
        Self::argument(error)
    }
}

impl From<WriteError> for Refusal {
    fn from(error: WriteError) -> Self {
        Self::asset(error)
    }
}

impl From<LibraryError> for Refusal {
    fn from(error: LibraryError) -> Self {
        match error {
            LibraryError::Name { .. }
            | LibraryError::Duplicate { .. }
            | LibraryError::Alike { .. } => Self::argument(error),
            LibraryError::Asset { .. } => Self::asset(error),
            other => Self::new(HTEX_STATUS_INVALID_LIBRARY, "invalid-library", other),
        }
    }
}
