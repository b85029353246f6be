//! The exit status of the command, and the error with which a failed command ends.

use std::borrow::Cow;
use std::fmt::Display;
use std::path::Path;

use htex_author::AuthorError;
use htex_base::files::FileError;
use htex_base::finding::{Finding, Hint, listed, plain};
use htex_base::storage::{StorageError, StorageProblem};
use htex_device::DeviceError;
use htex_format::ReadError;
use htex_format::library::LibraryError;
use htex_host::HostError;
use htex_scene::SceneError;

use crate::located::with_uris;
use crate::output::shown;

/// The result of a command or of a part of one.
pub(crate) type Result<T = Exit, E = Failure> = std::result::Result<T, E>;

/// An exit status. Unlike `std::process::ExitCode`, its number can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Exit(u8);

impl Exit {
    /// Nothing failed and nothing was found.
    pub(crate) const SUCCESS: Self = Self(0);
    /// A failure, or findings.
    pub(crate) const FAILURE: Self = Self(1);
    /// Wrong usage.
    pub(crate) const USAGE: Self = Self(2);
    /// Some results were made, and others were left out.
    #[cfg(feature = "build")]
    pub(crate) const PART: Self = Self(3);

    /// Returns the status of a check: success if there are no findings.
    pub(crate) fn ok_if(is_clean: bool) -> Self {
        if is_clean { Self::SUCCESS } else { Self::FAILURE }
    }

    /// Returns the status with which the process ends.
    pub(crate) fn code(self) -> u8 {
        self.0
    }
}

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// An error whose message does not name the file, together with this file.
    #[error("{file}: {error}")]
    InFile { file: String, error: Box<Failure> },
    #[error(transparent)]
    Author(AuthorError),
    #[error(transparent)]
    Recording(#[from] htex_author::recording::ReadError),
    #[error(transparent)]
    Model(#[from] HostError),
    #[error(transparent)]
    Device(#[from] DeviceError),
    #[error(transparent)]
    Storage(#[from] StorageError),
    #[error("{}{}", .0, flag_of(.0))]
    Asset(htex::Error),
    #[error(transparent)]
    Library(LibraryError),
    #[error("{cannot} (`htex explain CODE` says more){}", listed(.findings))]
    Findings {
        /// What the findings prevent, e.g. `this scene cannot be played`.
        cannot: &'static str,
        findings: Vec<Finding>,
    },
    #[error(transparent)]
    Scene(Box<SceneError>),
    #[cfg(feature = "build")]
    #[error(transparent)]
    Build(htex_build::BuildError),
    #[cfg(feature = "lab")]
    #[error(transparent)]
    Lab(#[from] htex_lab::LabError),
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
    /// Reports that the command line is invalid.
    pub(crate) fn usage(error: impl Display) -> Self {
        Self::Usage(error.to_string())
    }

    /// Reports an error that has no variant of its own.
    pub(crate) fn other(error: impl Display) -> Self {
        Self::Other(error.to_string())
    }

    /// Adds the file that the error is about, unless the error is about an argument or already
    /// names its file.
    pub(crate) fn in_file(self, file: &Path) -> Self {
        match self {
            Self::Usage(_) | Self::File(_) | Self::Storage(_) | Self::InFile { .. } => self,
            error => Self::InFile { file: shown(file), error: Box::new(error) },
        }
    }

    /// Returns the error without its file.
    pub(crate) fn cause(&self) -> &Self {
        match self {
            Self::InFile { error, .. } => error.cause(),
            error => error,
        }
    }

    /// Returns 2 for wrong usage, else 1.
    pub(crate) fn exit(&self) -> Exit {
        use DeviceError::{Rate, Setting, Unknown};
        use HostError::{OptionValue, UnknownModel, UnknownOption};
        use StorageProblem::{NoCloud, ReadOnly};
        match self.cause() {
            #[cfg(feature = "lab")]
            Self::Lab(error) if error.is_usage() => Exit::USAGE,
            Self::Usage(_)
            | Self::Model(UnknownOption { .. } | OptionValue { .. } | UnknownModel { .. })
            | Self::Device(Setting { .. } | Rate { .. } | Unknown { .. })
            | Self::Storage(StorageError { problem: NoCloud | ReadOnly, .. })
            | Self::Asset(
                htex::Error::Model(UnknownModel { .. })
                | htex::Error::EmbeddedOff { .. }
                | htex::Error::ModelOlder { embedded: true, .. },
            ) => Exit::USAGE,
            _ => Exit::FAILURE,
        }
    }

    /// Returns the lines of the message. The message may quote files and their names, so control
    /// characters are escaped. Quoted text can therefore not begin a new line.
    pub(crate) fn to_lines(&self) -> Vec<String> {
        let text = self.to_string();
        // The message about a recipe has several lines: it shows the position in the TOML file,
        // with a mark under it.
        #[cfg(feature = "build")]
        if let Self::Build(htex_build::BuildError::Recipe(_)) = self.cause() {
            return text.lines().map(shown_line).collect();
        }
        let findings = match self.cause() {
            Self::Findings { findings, .. }
            | Self::Author(AuthorError::Strict { findings, .. }) => &findings[..],
            _ => &[],
        };
        let first = match text.split_once('\n') {
            // The message also lists the findings, but without flags. The lines with flags are
            // added below.
            Some((first, _)) if !findings.is_empty() => first,
            _ => &text,
        };
        let first = with_flags(first, self.flags());
        let for_finding = findings.iter().map(|finding| {
            let line = format!("  {} {finding}", finding.severity);
            // Commands that play a texture run its embedded models unless a flag forbids it.
            let is_off = finding.hint == htex_scene::ALLOW_EMBEDDED;
            let flags = is_off.then(|| "--no-embedded-plugins".to_owned());
            with_flags(&line, flags.or_else(|| flags_for(finding.hint))).into_owned()
        });
        let lines = std::iter::once(first.into_owned()).chain(for_finding);
        lines.map(|line| shown_line(&line)).collect()
    }

    /// Returns the flags that would fix the error.
    fn flags(&self) -> Option<String> {
        let flags = flags_for(match self.cause() {
            Self::Author(error) => error.hint(),
            Self::Recording(error) => error.hint(),
            #[cfg(feature = "lab")]
            Self::Lab(error) => error.hint(),
            Self::Device(
                DeviceError::Setting { .. }
                | DeviceError::DirectVoltage { .. }
                | DeviceError::Underflow { .. },
            ) => Hint::new(&["set"]),
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

/// Converts an error, and adds the file that it is about.
pub(crate) fn for_file<E: Into<Failure>>(file: &Path) -> impl FnOnce(E) -> Failure {
    move |error| error.into().in_file(file)
}

/// Returns the settings of a hint as flags. A setting has the same name as its flag.
fn flags_for(hint: Hint) -> Option<String> {
    let flag = |setting: &&str| format!("--{}", setting.replace('_', "-"));
    let flags: Vec<String> = hint.settings().iter().map(flag).collect();
    (!flags.is_empty()).then(|| flags.join(", "))
}

/// Adds the flags that would fix the problem to a message, before the full stop or colon at its
/// end.
pub(crate) fn with_hint(message: &str, hint: Hint) -> Cow<'_, str> {
    with_flags(message, flags_for(hint))
}

fn with_flags(message: &str, flags: Option<String>) -> Cow<'_, str> {
    let Some(flags) = flags else {
        return Cow::Borrowed(message);
    };
    let body = message.strip_suffix(['.', ':']).unwrap_or(message);
    let end = &message[body.len()..];
    Cow::Owned(format!("{body} (see {flags}){end}"))
}

/// Maximum number of characters shown per line, because a message may quote a long text from a
/// file.
const MOST_SHOWN: usize = 8000;

fn shown_line(line: &str) -> String {
    // URIs are put in before escaping, because an escaped path would not be found.
    let line = with_uris(line);
    let line = plain(&line);
    match line.char_indices().nth(MOST_SHOWN) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.into_owned(),
    }
}

/// Returns the flag that caused an error of the crate `htex`, whose messages do not name flags.
fn flag_of(error: &htex::Error) -> &'static str {
    match error {
        htex::Error::EmbeddedOff { .. } | htex::Error::ModelOlder { embedded: true, .. } => {
            " (by --no-embedded-plugins)"
        }
        _ => "",
    }
}

impl From<htex::Error> for Failure {
    /// A wrong rate or grid of a block for microcontrollers comes from flags, so it is wrong usage.
    fn from(error: htex::Error) -> Self {
        match error {
            htex::Error::BakeRate { .. } => Self::Usage(format!("--rate {error}")),
            htex::Error::Axis { .. } | htex::Error::Incomplete { .. } => {
                Self::Usage(format!("--at, --grid: {error}"))
            }
            error => Self::Asset(error),
        }
    }
}

impl From<htex_format::WriteError> for Failure {
    fn from(error: htex_format::WriteError) -> Self {
        Self::Author(AuthorError::Asset(error))
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        htex::Error::from(error).into()
    }
}

impl From<AuthorError> for Failure {
    /// Names a wrong setting by its flag. An error that no flag caused, e.g. that a file cannot be
    /// read, stays as it is.
    fn from(error: AuthorError) -> Self {
        match error {
            AuthorError::Model(error) => Self::Model(error),
            AuthorError::Read(error) => Self::Recording(error),
            AuthorError::Map { keyword, text, error } => {
                let flag = keyword.replace('_', "-");
                Self::Usage(format!("--{flag} {text}: {error}"))
            }
            AuthorError::Trackers { .. } => Self::Usage(format!("--tracker: {error}")),
            AuthorError::GridText { .. }
            | AuthorError::ModelNotFitted { .. }
            | AuthorError::OptionForm { .. }
            | AuthorError::Metadata { .. } => Self::Usage(format!("--{error}")),
            error => Self::Author(error),
        }
    }
}

impl From<LibraryError> for Failure {
    fn from(error: LibraryError) -> Self {
        match error {
            LibraryError::Open { path, error } => FileError::reading(path, error).into(),
            LibraryError::Write { path, error } => FileError::writing(path, error).into(),
            LibraryError::Storage(error) => error.into(),
            LibraryError::Asset { error, .. } => (*error).into(),
            error => Self::Library(error),
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Io { path, error } => FileError::reading(path, error).into(),
            SceneError::Invalid { findings } => {
                Self::Findings { cannot: "this scene cannot be played", findings }
            }
            error => Self::Scene(Box::new(error)),
        }
    }
}

#[cfg(feature = "build")]
impl From<htex_build::BuildError> for Failure {
    fn from(error: htex_build::BuildError) -> Self {
        match error {
            htex_build::BuildError::File(error) => error.into(),
            htex_build::BuildError::Storage(error) => error.into(),
            error => Self::Build(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::commands::explain::rules;

    #[test]
    fn flags_stand_before_the_end_of_the_sentence() {
        let hint = Hint::new(&["from", "most_numbers"]);
        for (text, expected) in [
            ("leave it out", "leave it out (see --from, --most-numbers)"),
            ("Leave it out.", "Leave it out (see --from, --most-numbers)."),
        ] {
            assert_eq!(with_hint(text, hint), expected);
        }
        assert_eq!(with_hint("leave it out", Hint::NONE), "leave it out");
    }

    #[test]
    fn hints_of_rules_are_flags_of_the_command() {
        let mut known = BTreeSet::new();
        for command in crate::command().get_subcommands() {
            known
                .extend(command.get_arguments().filter_map(clap::Arg::get_long).map(str::to_owned));
        }
        for rule in rules() {
            for setting in [rule.hint, rule.checked_by].iter().flat_map(|hint| hint.settings()) {
                let flag = setting.split(' ').next().unwrap_or_default().replace('_', "-");
                assert!(known.contains(&flag), "{}: {flag}", rule.code);
            }
        }
    }
}
