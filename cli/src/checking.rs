//! What the checkers of models and of devices have in common.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use htex_check::Finding;

use crate::failure::Failure;
use crate::output::{print, print_json};

/// Tells what a single check found.
pub(crate) fn tell_one(name: &str, finding: &Finding, json: bool) -> Result<ExitCode, Failure> {
    if json {
        print_json(finding)?;
    } else {
        let word = finding.outcome.word();
        print(&format!("{name}: {word}: {}\n", finding.message))?;
    }
    Ok(exit_code(finding.outcome.is_bad()))
}

/// The time a check may take, from `--timeout`.
pub(crate) fn timeout(seconds: f64) -> Result<Duration, Failure> {
    Duration::try_from_secs_f64(seconds)
        .ok()
        .filter(|timeout| !timeout.is_zero() && timeout.as_secs() < 1_000_000)
        .ok_or_else(|| Failure::Usage(format!("--timeout {seconds}: seconds, more than 0")))
}

/// The program that runs each check: this one.
pub(crate) fn this_program() -> Result<PathBuf, Failure> {
    std::env::current_exe()
        .map_err(|error| Failure::Other(format!("cannot find this program: {error}")))
}

pub(crate) fn exit_code(bad: bool) -> ExitCode {
    if bad {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}
