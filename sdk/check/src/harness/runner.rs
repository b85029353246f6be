//! Runs a single check in this process, or each check in a separate process.

use std::ffi::OsString;
use std::fmt::Display;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use crate::harness::process::run_process;
use crate::harness::table::{Check, find};
use crate::harness::{CheckError, CheckReport, Finding};

/// The steps of loading, in their order. Each step has a check with the same name.
const LOADING: [&str; 3] = ["marker", "exports", "descriptor"];

/// The check that reports an error in loading a model or a device.
#[derive(Debug, Clone, Copy)]
pub struct Owner {
    check: &'static str,
    /// Whether the loading steps before this check passed.
    reached: bool,
}

impl Owner {
    /// Names the check that reports the error, and states that the loading steps before this check
    /// passed.
    pub fn reached(check: &'static str) -> Self {
        let reached = true;
        Self { check, reached }
    }

    /// States that the error belongs to this check, and that it is unknown whether the steps before
    /// it passed.
    pub(crate) fn not_reached(check: &'static str) -> Self {
        let reached = false;
        Self { check, reached }
    }
}

/// A program that runs one check in its own process and writes the [`Finding`] as a line of JSON.
#[derive(Debug, Clone)]
pub struct Runner {
    pub program: PathBuf,
    /// The program's first arguments. The checker appends the arguments that name the check.
    pub arguments: Vec<OsString>,
    /// Longest time of one check.
    pub timeout: Duration,
}

/// Runs each check in a separate process. `add_arguments` appends the arguments that name the
/// check. A check is skipped if a check that it needs failed, or was itself skipped for this
/// reason. If a check is skipped because it does not apply, the checks that need it still run.
pub(crate) fn run_all<'a, Case: 'a>(
    checks: impl IntoIterator<Item = &'a Check<Case>>,
    runner: &Runner,
    add_arguments: impl Fn(&mut Command, &'static str),
) -> Vec<CheckReport> {
    let mut broken: Vec<&str> = Vec::new();
    let mut reports = Vec::new();
    for check in checks {
        let need = check.needs.iter().find(|name| broken.contains(name));
        let finding = match need {
            Some(need) => Finding::skipped(format!("it needs `{need}`, which did not pass")),
            None => {
                let mut command = Command::new(&runner.program);
                command.args(&runner.arguments);
                add_arguments(&mut command, check.name);
                run_process(&mut command, runner.timeout)
            }
        };
        if need.is_some() || finding.outcome.is_bad() {
            broken.push(check.name);
        }
        reports.push(CheckReport { check: check.name, finding });
    }
    reports
}

/// Runs one check in this process. A crash ends the process. `load` loads the model or device.
/// `owner` returns the check that reports a loading error.
///
/// # Errors
/// Returns an error if the table has no check of this name.
pub fn run_one<Case, Error: Display>(
    checks: &[Check<Case>],
    name: &str,
    load: impl FnOnce() -> Result<Case, Error>,
    owner: impl FnOnce(&Error) -> Owner,
) -> Result<Finding, CheckError> {
    let check = find(checks, name)?;
    let error = match load() {
        Ok(case) => return Ok((check.run)(&case).unwrap_or_else(|finding| finding)),
        Err(error) => error,
    };
    let Owner { check: broken, reached } = owner(&error);
    Ok(if broken == check.name {
        Finding::failed(error.to_string())
    } else if reached && comes_before(check.name, broken) {
        Finding::passed(format!("loading reached `{broken}`"))
    } else {
        Finding::skipped(format!("it does not load: {error}"))
    })
}

/// Returns whether the loading step `name` precedes the step `broken`.
fn comes_before(name: &str, broken: &str) -> bool {
    let place = |name: &str| LOADING.iter().position(|stage| *stage == name);
    matches!((place(name), place(broken)), (Some(a), Some(b)) if a < b)
}
