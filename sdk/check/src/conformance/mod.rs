//! Runs a third-party reader on the conformance files of `spec`, and counts the right answers.
//!
//! The reader is a program in any language. The runner starts the reader once for each file, and
//! compares the JSON object that the reader prints with the expected values in the conformance
//! files. `spec/conformance-protocol.md` specifies the object.
//!
//! The reader may hang, print without end, or start programs of its own. Therefore each run has a
//! limit of time and of output. Each run also has its own process group, which the runner kills at
//! the end ([`run`]). Systems other than Unix have no process groups, so the runner kills only the
//! reader itself.
#![forbid(unsafe_code)]

mod answer;
mod compare;
mod line;
mod process;
mod report;
mod run;
mod tasks;

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use serde::Serialize;

pub use line::CommandLine;
pub use report::{Count, Difference, Left, Matrix, Report, Row};
pub use run::{Options, run};

/// A kind of conformance file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    Assets,
    Libraries,
    Scenes,
    Recordings,
    Baked,
    Playing,
}

impl Part {
    /// All parts, in the order in which the matrix of results lists them.
    pub const ALL: [Self; 6] =
        [Self::Assets, Self::Libraries, Self::Scenes, Self::Recordings, Self::Baked, Self::Playing];

    /// Returns the name of the part, which replaces `{part}` in the reader's command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Assets => "assets",
            Self::Libraries => "libraries",
            Self::Scenes => "scenes",
            Self::Recordings => "recordings",
            Self::Baked => "baked",
            Self::Playing => "playing",
        }
    }

    /// Returns the name of the part's folder in `spec`.
    pub const fn folder(self) -> &'static str {
        match self {
            Self::Assets => "conformance",
            Self::Libraries => "library-conformance",
            Self::Scenes => "scene-conformance",
            Self::Recordings => "recording-conformance",
            Self::Baked => "baked-conformance",
            Self::Playing => "playing-conformance",
        }
    }
}

/// A conformance class of the specification: an ability that a program of this class must have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Class {
    /// Finds every mistake in a file, and reports the code of the mistake and the JSON pointer to
    /// it.
    Validator,
    /// Accepts valid files and refuses invalid ones.
    Reader,
    /// Computes the numbers with which a texture is played, such as its level.
    Player,
}

impl Class {
    /// All classes, in the order in which the matrix of results lists them.
    pub const ALL: [Self; 3] = [Self::Validator, Self::Reader, Self::Player];

    /// Returns the name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Validator => "validator",
            Self::Reader => "reader",
            Self::Player => "player",
        }
    }
}

macro_rules! names {
    ($($kind:ident, $what:literal;)*) => {$(
        impl fmt::Display for $kind {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.name())
            }
        }

        impl FromStr for $kind {
            type Err = String;

            fn from_str(text: &str) -> Result<Self, String> {
                let found = Self::ALL.into_iter().find(|one| one.name() == text);
                found.ok_or_else(|| {
                    let known = Self::ALL.map(Self::name).join(", ");
                    format!(concat!("there is no ", $what, " `{}`; there are {}"), text, known)
                })
            }
        }
    )*};
}

names! {
    Part, "part";
    Class, "class";
}

/// The error when a reader cannot be run on the conformance files.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConformanceError {
    /// The reader's command is invalid or cannot be started.
    #[error("the command `{command}` {problem}")]
    Command { command: String, problem: String },
    /// The folder has no conformance files, or no files of the requested part.
    #[error("{}: {problem}; give the folder `spec` of htex, or the one of a release", path.display())]
    Files { path: PathBuf, problem: String },
    /// A conformance file cannot be read, or the input file for the reader cannot be written.
    #[error("{}: {error}", path.display())]
    File { path: PathBuf, error: std::io::Error },
    /// Somebody stopped the run.
    #[error("it was stopped after {done} of {all} files")]
    Stopped { done: usize, all: usize },
}
