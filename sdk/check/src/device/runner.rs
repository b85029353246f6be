//! Runs the checks of a device.

use std::collections::BTreeMap;
use std::fmt::{self, Display};
use std::process::Command;

use htex_device::{DeviceError, Direction, LibraryFault};
use serde::Serialize;

use crate::device::case::{Case, Subject};
use crate::device::table::{CHECKS, checks_of};
use crate::harness::{self, CheckError, Finding, Owner, Runner, run_all, run_process};

/// Name of a pseudo-check in which a child process reports the direction of a library. The
/// direction determines which checks run. Only child processes load a library, because loading may
/// crash.
const DIRECTION: &str = "direction";

/// The results of all checks of one device.
pub type Report = harness::Report<DeviceName>;

/// The device that was checked: the library's file, or the id of a built-in device.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviceName {
    pub device: String,
}

impl Display for DeviceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.device)
    }
}

/// Runs all checks of a device, each check in its own process. `runner` names a program that calls
/// [`run_one`], and the program's first arguments. These arguments name the device and its
/// settings. The checker appends the name of the check as the last argument.
pub fn check(device: &str, subject: &Subject, runner: &Runner) -> Report {
    let direction = match subject {
        Subject::Builtin(adapter) => Some(adapter.descriptor().direction),
        Subject::Library(_) => direction_of_library(runner),
    };
    let checks = run_all(checks_of(direction), runner, |command, name| {
        command.arg(name);
    });
    Report::new(DeviceName { device: device.to_owned() }, checks)
}

/// Returns the direction of a library that can be loaded.
fn direction_of_library(runner: &Runner) -> Option<Direction> {
    let mut command = Command::new(&runner.program);
    command.args(&runner.arguments).arg(DIRECTION);
    let finding = run_process(&mut command, runner.timeout);
    let all = [Direction::Output, Direction::Input];
    all.into_iter().find(|direction| direction.to_string() == finding.message)
}

/// Runs one check in this process. A crash ends the process.
///
/// # Errors
/// Returns an error if no check has this name.
pub fn run_one(
    subject: &Subject,
    name: &str,
    profile: Option<&str>,
    given: &BTreeMap<String, String>,
) -> Result<Finding, CheckError> {
    let load = || Case::load(subject, profile, given);
    if name == DIRECTION {
        return Ok(
            load().map_or_else(Finding::from, |case| Finding::passed(case.direction().to_string()))
        );
    }
    harness::run_one(CHECKS, name, load, owner)
}

/// Returns the check to which a loading error belongs.
fn owner(error: &DeviceError) -> Owner {
    let DeviceError::Library { fault, .. } = error else {
        return Owner::not_reached("exports");
    };
    match fault {
        LibraryFault::Marker => Owner::reached("marker"),
        LibraryFault::Function => Owner::reached("exports"),
        LibraryFault::Descriptor => Owner::reached("descriptor"),
        // A file that cannot be loaded has no marker to check.
        _ => Owner::not_reached("exports"),
    }
}
