//! Running the checks of a device.

use std::collections::BTreeMap;

use htex_check_runner::{Finding, Runner, UnknownCheck, run_all};

use crate::case::{Case, Subject};
use crate::checks::describe::owner;
use crate::report::{DeviceName, Report};
use crate::table::CHECKS;

/// Runs all checks of `device`, each in a process of its own. `runner` is a program that calls [`run_one`]; it gets its own
/// arguments, which name the device and its settings, then the check's name.
pub fn check(device: &str, runner: &Runner) -> Report {
    let checks = run_all(CHECKS, runner, |command, name| {
        command.arg(name);
    });
    let subject = DeviceName {
        device: device.to_owned(),
    };
    Report::new(subject, checks)
}

/// Runs one check in this process: a crash ends the process.
///
/// # Errors
/// When there is no check of this name.
pub fn run_one(
    subject: &Subject,
    name: &str,
    profile: Option<&str>,
    given: &BTreeMap<String, String>,
) -> Result<Finding, UnknownCheck> {
    let load = || Case::load(subject, profile, given);
    htex_check_runner::run_one(CHECKS, name, load, owner)
}
