//! How the command was started: its arguments, and the program that starts it again.
//!
//! The caller passes the program that starts the command again. It cannot be determined here,
//! because in the Python package the running program is the Python interpreter.

use std::ffi::OsString;
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use crate::failure::{Failure, Result};

/// The arguments and the program of the current run.
static CURRENT: Mutex<Invocation> =
    Mutex::new(Invocation { arguments: Vec::new(), program: Vec::new() });

struct Invocation {
    arguments: Vec<OsString>,
    program: Vec<OsString>,
}

/// The program that starts the command again, with its first arguments, e.g. `python -m htex`.
#[derive(Debug, Clone)]
pub(crate) struct Program {
    pub(crate) file: OsString,
    pub(crate) arguments: Vec<OsString>,
}

impl Program {
    /// Returns a command that starts the program.
    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(&self.file);
        command.args(&self.arguments);
        command
    }
}

/// Stores the program of this run, and its arguments without the program's name, in a form that may
/// be shown.
pub(crate) fn set(arguments: Vec<OsString>, program: Vec<OsString>) {
    // Set for each run, because a process of the Python package may run several commands.
    *CURRENT.lock().unwrap_or_else(PoisonError::into_inner) = Invocation { arguments, program };
}

/// Returns the arguments of this run, without the program's name.
pub(crate) fn arguments() -> Vec<OsString> {
    let current = CURRENT.lock().unwrap_or_else(PoisonError::into_inner);
    current.arguments.clone()
}

/// Returns the program that starts the command again.
///
/// # Errors
/// When the program is unknown.
pub(crate) fn program() -> Result<Program> {
    let current = CURRENT.lock().unwrap_or_else(PoisonError::into_inner);
    let (file, arguments) = current.program.split_first().ok_or_else(|| {
        Failure::other("cannot find this program; start it by the path of its file")
    })?;
    Ok(Program { file: file.clone(), arguments: arguments.to_vec() })
}

/// Returns the name and version of this program, for an asset's provenance.
pub(crate) fn tool() -> String {
    concat!("htex ", env!("CARGO_PKG_VERSION")).to_owned()
}

/// Returns this run's command line. Words with characters that are unusual in a path are quoted.
pub(crate) fn command_line() -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:=,+%@".contains(c);
    let quoted = |word: OsString| match word.to_string_lossy() {
        word if !word.is_empty() && word.chars().all(is_plain) => word.into_owned(),
        word => format!("'{}'", word.replace('\'', r"'\''")),
    };
    let words = arguments().into_iter().map(quoted);
    let words: Vec<String> = std::iter::once("htex".to_owned()).chain(words).collect();
    words.join(" ")
}
