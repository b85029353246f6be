//! The one sentence a failed command ends with.

use std::path::Path;
use std::process::ExitCode;

/// What went wrong, with its place.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error(transparent)]
    Author(#[from] htex_author::AuthorError),
    #[error(transparent)]
    Recording(#[from] htex_author::read::ReadError),
    #[error(transparent)]
    Model(#[from] htex_host::HostError),
    #[error(transparent)]
    Device(#[from] htex_device::DeviceError),
    #[error("{file}: {error}")]
    Asset { file: String, error: htex::Error },
    #[error("cannot read {file}: {error}")]
    Read { file: String, error: std::io::Error },
    #[error("cannot write {file}: {error}")]
    Write { file: String, error: std::io::Error },
    /// The command line asks for something that cannot be asked for.
    #[error("{0}")]
    Usage(String),
    #[error("{0}")]
    Other(String),
}

impl Failure {
    /// 2 for wrong usage, else 1.
    pub(crate) fn exit_code(&self) -> ExitCode {
        use htex_device::DeviceError::{Rate, Setting, Unknown};
        use htex_host::HostError::{Option, UnknownModel};
        match self {
            Self::Usage(_)
            | Self::Model(Option { .. } | UnknownModel { .. })
            | Self::Device(Setting { .. } | Rate { .. } | Unknown { .. })
            | Self::Asset {
                error: htex::Error::Model(UnknownModel { .. }),
                ..
            } => ExitCode::from(2),
            _ => ExitCode::FAILURE,
        }
    }

    pub(crate) fn asset(file: &Path, error: impl Into<htex::Error>) -> Self {
        Self::Asset {
            file: file.display().to_string(),
            error: error.into(),
        }
    }

    pub(crate) fn read(file: &Path, error: std::io::Error) -> Self {
        Self::Read {
            file: file.display().to_string(),
            error,
        }
    }

    pub(crate) fn write(file: &Path, error: std::io::Error) -> Self {
        Self::Write {
            file: file.display().to_string(),
            error,
        }
    }
}
