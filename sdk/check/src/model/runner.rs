//! Runs the checks of a model.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::harness::{CheckError, Finding, Runner, run_all, select};

use crate::model::case::{Case, Settings};
use crate::model::checks::abi::owner;
use crate::model::report::{ModelFile, Report};
use crate::model::table::CHECKS;

#[derive(Debug, Clone)]
pub struct Options {
    /// A program that calls [`run_one`]. The checker starts this program with the arguments in
    /// [`Runner`], followed by the model's file, the name of the check, and the option for the
    /// seed. If the check compares the model with a second file, the option for the second file
    /// comes last.
    pub runner: Runner,
    /// Seed of the voices.
    pub seed: u64,
    /// Names of the checks to run. The runner also runs every check that these checks depend on.
    /// `None` runs all checks.
    pub only: Option<Vec<String>>,
    /// The same model as a file of the other kind (native library or WASM module).
    pub against: Option<PathBuf>,
    /// Duration of the check `fuzz`. If `None`, the check runs a fixed number of random sequences
    /// of calls.
    pub fuzz: Option<Duration>,
}

/// Returns an error if the file cannot be read. Otherwise a check would blame the model.
fn readable(file: &Path) -> Result<(), CheckError> {
    let is_file = std::fs::File::open(file).and_then(|opened| opened.metadata());
    let error = match is_file {
        Ok(metadata) if metadata.is_file() => return Ok(()),
        Ok(_) => std::io::Error::other("it is not a file"),
        Err(error) => error,
    };
    let path = file.to_owned();
    Err(CheckError::File { path, error })
}

/// Runs the checks, each in a separate process.
///
/// # Errors
/// Returns an error if the file cannot be read, or `only` names an unknown check.
pub fn check(file: &Path, options: &Options) -> Result<Report, CheckError> {
    readable(file)?;
    let chosen = match &options.only {
        Some(names) => select(CHECKS, names)?,
        None => CHECKS.iter().collect(),
    };
    let mut runner = options.runner.clone();
    runner.timeout += options.fuzz.unwrap_or_default();
    let checks = run_all(chosen, &runner, |command, name| {
        command.arg(file).arg(name);
        command.args(["--seed", &options.seed.to_string()]);
        if let Some(against) = &options.against {
            command.arg("--against").arg(against);
        }
        if let Some(time) = options.fuzz {
            command.args(["--fuzz", &time.as_secs_f64().to_string()]);
        }
    });
    let subject = ModelFile { file: file.display().to_string(), seed: options.seed };
    Ok(Report::new(subject, checks))
}

/// Runs one check in this process. A crash ends the process.
///
/// # Errors
/// Returns an error if the file cannot be read, or no check has this name.
pub fn run_one(file: &Path, name: &str, settings: Settings<'_>) -> Result<Finding, CheckError> {
    readable(file)?;
    let load = || Case::load(file, settings);
    crate::harness::run_one(CHECKS, name, load, owner)
}
