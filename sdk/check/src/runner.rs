//! Running the checks of a model.

use std::path::{Path, PathBuf};

use htex_check_runner::{Finding, Runner, UnknownCheck, run_all, select};

use crate::case::Case;
use crate::checks::abi::owner;
use crate::report::{ModelFile, Report};
use crate::table::CHECKS;

#[derive(Debug, Clone)]
pub struct Options {
    /// A program that calls [`run_one`]. After its own arguments it receives the file, the check's name and the options
    /// for the seed and for the other file, if there is one.
    pub runner: Runner,
    /// Seed of the voices.
    pub seed: u64,
    /// Checks to run, with those that they need; all when `None`.
    pub only: Option<Vec<String>>,
    /// The same model as a file of the other kind.
    pub against: Option<PathBuf>,
}

/// Runs the checks, each in a separate process.
///
/// # Errors
/// When `only` names an unknown check.
pub fn check(file: &Path, options: &Options) -> Result<Report, UnknownCheck> {
    let chosen = match &options.only {
        Some(names) => select(CHECKS, names)?,
        None => CHECKS.iter().collect(),
    };
    let checks = run_all(chosen, &options.runner, |command, name| {
        command.arg(file).arg(name);
        command.args(["--seed", &options.seed.to_string()]);
        if let Some(against) = &options.against {
            command.arg("--against").arg(against);
        }
    });
    let subject = ModelFile {
        file: file.display().to_string(),
        seed: options.seed,
    };
    Ok(Report::new(subject, checks))
}

/// Runs one check in this process: a crash ends the process.
///
/// # Errors
/// When there is no check of this name.
pub fn run_one(
    file: &Path,
    name: &str,
    seed: u64,
    against: Option<&Path>,
) -> Result<Finding, UnknownCheck> {
    let load = || Case::load(file, seed, against);
    htex_check_runner::run_one(CHECKS, name, load, owner)
}
