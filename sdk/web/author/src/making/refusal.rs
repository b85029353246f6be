//! Errors of the functions that make textures.

use htex_author::by_hand::ByHandError;
use htex_author::recording::{ReadError, ReadProblem};
use htex_author::settings::SettingsError;
use htex_author::{AuthorError, EditError};
use htex_c::htex_status::*;
use htex_format::library::LibraryError;
use htex_format::{ReadError as AssetError, WriteError};

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

impl From<SettingsError> for Refusal {
    fn from(error: SettingsError) -> Self {
        match error {
            SettingsError::Model(error) => error.into(),
            other => Self::argument(other),
        }
    }
}

impl From<AuthorError> for Refusal {
    fn from(error: AuthorError) -> Self {
        match error {
            AuthorError::Model(error) => error.into(),
            AuthorError::Read(error) => error.into(),
            AuthorError::Asset(error) => error.into(),
            AuthorError::NothingFitted { .. } => Self::model(error),
            AuthorError::GridText { .. } | AuthorError::LoopRate { .. } => Self::argument(error),
            other => Self::recording(other),
        }
    }
}

impl From<ByHandError> for Refusal {
    fn from(error: ByHandError) -> Self {
        match error {
            ByHandError::Model(error) => error.into(),
            ByHandError::Write(error) => error.into(),
            other => Self::argument(other),
        }
    }
}

impl From<EditError> for Refusal {
    fn from(error: EditError) -> Self {
        Self::asset(error)
    }
}

impl From<AssetError> for Refusal {
    fn from(error: AssetError) -> Self {
        Self::asset(error)
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
