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
    #[error(transparent)]
    Tradeoff(#[from] htex_tradeoff::TradeoffError),
    #[error("{file}: {error}")]
    Asset { file: String, error: htex::Error },
    #[error("{file}: {}", findings_text(.findings))]
    Findings {
        file: String,
        findings: Vec<htex_format::Finding>,
    },
    #[error("{file}: {error}")]
    Scene {
        file: String,
        error: Box<htex_scene::SceneError>,
    },
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

    /// A scene that could not be loaded.
    pub(crate) fn load(file: &Path, error: htex_scene::LoadError) -> Self {
        match error {
            htex_scene::LoadError::Io { path, error } => Self::read(&path, error),
            htex_scene::LoadError::Invalid { findings } => Self::Findings {
                file: file.display().to_string(),
                findings,
            },
        }
    }

    /// A scene that could not be planned or played.
    pub(crate) fn scene(file: &Path, error: htex_scene::SceneError) -> Self {
        Self::Scene {
            file: file.display().to_string(),
            error: Box::new(error),
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

/// Findings, one a line.
fn findings_text(findings: &[htex_format::Finding]) -> String {
    let line = |f: &htex_format::Finding| format!("\n  {} {f}", f.severity);
    let lines: String = findings.iter().map(line).collect();
    format!("this scene cannot be played (`htex explain CODE` says more){lines}")
}
