//! Runs programs and waits until they end.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

use anyhow::{Context, Result, bail};

/// Returns a command that runs a program in a folder. Arguments can be added.
pub(crate) fn program(name: impl AsRef<OsStr>, folder: &Path) -> Command {
    let mut command = Command::new(name);
    command.current_dir(folder);
    command
}

/// Runs a program and waits for its end.
///
/// # Errors
/// If the program cannot be run or fails. It has already printed its own output.
pub fn run(command: &mut Command) -> Result<()> {
    forget_package(command);
    let status = command.status();
    check(command, status.with_context(|| name(command))?)
}

/// Runs a program, waits for its end, and returns what it wrote to standard output.
///
/// # Errors
/// As [`run`].
pub(crate) fn output(command: &mut Command) -> Result<Vec<u8>> {
    forget_package(command);
    let output = command.stderr(Stdio::inherit()).output().with_context(|| name(command))?;
    check(command, output.status).map(|()| output.stdout)
}

fn name(command: &Command) -> String {
    command.get_program().to_string_lossy().into_owned()
}

fn check(command: &Command, status: ExitStatus) -> Result<()> {
    if status.success() {
        return Ok(());
    }
    let arguments: Vec<_> = command.get_args().map(OsStr::to_string_lossy).collect();
    bail!("{} {}: {status}", name(command), arguments.join(" "))
}

/// Removes the variables that cargo sets for the package it runs. Otherwise, build scripts that
/// watch these variables (such as `ring`'s) would run again when this program starts cargo, and
/// once more when the user next starts cargo. Both times, all crates that depend on these build
/// scripts would be rebuilt, i.e. most crates of this workspace.
pub fn forget_package(command: &mut Command) -> &mut Command {
    for (name, _) in std::env::vars_os() {
        let is_of_package = ["CARGO_PKG_", "CARGO_MANIFEST_"]
            .iter()
            .any(|start| name.to_string_lossy().starts_with(start));
        if is_of_package {
            command.env_remove(name);
        }
    }
    command
}
