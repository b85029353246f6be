//! The error with which a failed command ends.

use htex_author::AuthorError;
use htex_base::files::FileError;
use htex_base::finding::{Finding, Hint, listed, plain};
#[cfg(feature = "lab")]
use htex_lab::record::RecordError;

use crate::exit::Exit;
use crate::hints::{flags_of, with_flags, with_hint};
use crate::located::named;

/// An error and where it occurred.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error(transparent)]
    Author(AuthorError),
    #[error(transparent)]
    Recording(#[from] htex_author::recording::ReadError),
    #[error(transparent)]
    Model(#[from] htex_host::HostError),
    #[error(transparent)]
    Device(#[from] htex_device::DeviceError),
    #[cfg(feature = "lab")]
    #[error(transparent)]
    Response(#[from] htex_lab::response::ResponseError),
    #[error(transparent)]
    Storage(#[from] htex_base::storage::StorageError),
    #[error("{file}: {error}{}", flag_of(.error))]
    Asset { file: String, error: htex::Error },
    #[error("{file}: {error}")]
    Library { file: String, error: htex_format::library::LibraryError },
    #[error("{file}: {cannot} (`htex explain CODE` says more){}", listed(.findings))]
    Findings {
        file: String,
        /// What cannot be done with them.
        cannot: &'static str,
        findings: Vec<Finding>,
    },
    #[error("{file}: {error}")]
    Scene { file: String, error: Box<htex_scene::SceneError> },
    #[cfg(feature = "build")]
    #[error("{recipe}: {error}")]
    Build { recipe: String, error: htex_build::BuildError },
    #[cfg(feature = "lab")]
    #[error(transparent)]
    Study(#[from] htex_lab::study::StudyError),
    #[cfg(feature = "lab")]
    #[error(transparent)]
    Record(#[from] htex_lab::record::RecordError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error("cannot write JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// The command line is invalid.
    #[error("{0}")]
    Usage(String),
    #[error("{0}")]
    Other(String),
}

impl Failure {
    /// Whether the error is a wrong argument of an experiment.
    #[cfg(feature = "lab")]
    fn is_wrong_use_of_lab(&self) -> bool {
        use htex_lab::response::ResponseError::{Column, Option};
        use htex_lab::study::StudyError::{Attribute, NoParticipant};
        matches!(
            self,
            Self::Study(Attribute { .. } | NoParticipant { .. })
                | Self::Response(Option { .. } | Column { .. })
        )
    }

    /// Whether the error is an unknown name of a device or source.
    pub(crate) fn is_unknown_name(&self) -> bool {
        use htex_device::DeviceError::{Unknown, UnknownSource};
        matches!(self, Self::Device(Unknown { .. } | UnknownSource { .. }))
    }

    /// Returns 2 for wrong usage, else 1.
    pub(crate) fn exit_code(&self) -> Exit {
        use htex_base::storage::{
            StorageError,
            StorageProblem::{NoCloud, ReadOnly},
        };
        use htex_device::DeviceError::{Rate, Setting, Unknown, UnknownSource};
        use htex_host::HostError::{Option, UnknownModel};
        #[cfg(feature = "lab")]
        if self.is_wrong_use_of_lab() {
            return Exit::USAGE;
        }
        #[cfg(feature = "lab")]
        if let Self::Record(RecordError::Setup { .. } | RecordError::NotMeasured { .. }) = self {
            return Exit::USAGE;
        }
        match self {
            Self::Usage(_)
            | Self::Model(Option { .. } | UnknownModel { .. })
            | Self::Device(Setting { .. } | Rate { .. } | Unknown { .. } | UnknownSource { .. })
            | Self::Storage(StorageError { problem: NoCloud | ReadOnly, .. })
            | Self::Asset {
                error:
                    htex::Error::Model(UnknownModel { .. })
                    | htex::Error::EmbeddedOff { .. }
                    | htex::Error::ModelOlder { embedded: true, .. },
                ..
            } => Exit::USAGE,
            _ => Exit::FAILURE,
        }
    }

    /// Returns the message line by line. It may quote files and their names, so control characters
    /// are escaped, and lines end only where this program ends them.
    pub(crate) fn to_lines(&self) -> Vec<String> {
        let text = self.to_string();
        if self.has_lines() {
            return text.lines().map(shown_line).collect();
        }
        let findings = self.findings();
        let first = match text.split_once('\n') {
            // The message also lists the findings, but without their flags. They are listed below.
            Some((first, _)) if !findings.is_empty() => first,
            _ => &text,
        };
        let first = with_flags(first, self.flags());
        let of_finding = findings.iter().map(|finding| {
            let line = format!("  {} {finding}", finding.severity);
            with_hint(&line, finding.hint).into_owned()
        });
        let lines = std::iter::once(first.into_owned()).chain(of_finding);
        lines.map(|line| shown_line(&line)).collect()
    }

    /// Whether the message itself consists of lines: the position in a TOML file with a mark under
    /// it.
    fn has_lines(&self) -> bool {
        #[cfg(feature = "build")]
        if let Self::Build { error: htex_build::BuildError::Recipe(_), .. } = self {
            return true;
        }
        false
    }

    /// Returns the findings at the end of the message, one line each.
    fn findings(&self) -> &[Finding] {
        match self {
            Self::Findings { findings, .. }
            | Self::Author(AuthorError::Strict { findings, .. }) => findings,
            _ => &[],
        }
    }

    /// Returns the flags that would fix the error.
    fn flags(&self) -> Option<String> {
        let flags = flags_of(match self {
            Self::Author(error) => error.hint(),
            Self::Recording(error) => error.hint(),
            #[cfg(feature = "lab")]
            Self::Response(error) => error.hint(),
            _ => Hint::NONE,
        });
        match self {
            Self::Author(AuthorError::Strict { .. }) => {
                flags.map(|flags| flags + "; `htex explain CODE` describes each")
            }
            _ => flags,
        }
    }
}

/// Maximum number of characters shown per line, because a message may quote a long text from a
/// file.
const MOST_SHOWN: usize = 8000;

fn shown_line(line: &str) -> String {
    // URIs are put in before escaping, because an escaped path would not be found.
    let named = named(line);
    let line = plain(&named);
    match line.char_indices().nth(MOST_SHOWN) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.into_owned(),
    }
}

impl From<htex_format::WriteError> for Failure {
    fn from(error: htex_format::WriteError) -> Self {
        Self::Author(AuthorError::Asset(error))
    }
}

/// Returns the flag that caused an error of the library, which knows no flags.
fn flag_of(error: &htex::Error) -> &'static str {
    match error {
        htex::Error::EmbeddedOff { .. } | htex::Error::ModelOlder { embedded: true, .. } => {
            " (by --no-embedded-plugins)"
        }
        _ => "",
    }
}
