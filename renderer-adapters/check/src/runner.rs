//! Running checks: one in this process, or each in a process of its own.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use htex_check::{CheckReport, Finding, run_process};

use crate::case::{Case, Subject};
use crate::checks::describe::owner;
use crate::report::DeviceReport;
use crate::table::{CHECKS, find};

/// How a device is checked.
#[derive(Debug, Clone)]
pub struct Options {
    /// A program that runs one check and writes its [`Finding`] as a line of JSON: it is called with
    /// `arguments`, then the check's name.
    pub program: PathBuf,
    /// What stands before the name.
    pub arguments: Vec<OsString>,
    /// How long one check may take.
    pub timeout: Duration,
}

/// Runs all checks of `device`, each in a process of its own.
pub fn check(device: &str, options: &Options) -> DeviceReport {
    let mut broken: BTreeSet<&str> = BTreeSet::new();
    let mut checks = Vec::new();
    for check in CHECKS {
        let missing = check.needs.iter().find(|name| broken.contains(*name));
        let missing = missing.map(|name| format!("it needs `{name}`, which did not pass"));
        let is_missing = missing.is_some();
        let finding = missing.map(Finding::skipped).unwrap_or_else(|| {
            let mut command = Command::new(&options.program);
            command.args(&options.arguments).arg(check.name);
            run_process(&mut command, options.timeout)
        });
        if is_missing || finding.outcome.is_bad() {
            broken.insert(check.name);
        }
        checks.push(CheckReport {
            check: check.name,
            finding,
        });
    }
    DeviceReport::new(device, checks)
}

/// Runs one check in this process: what crashes, crashes.
///
/// # Errors
/// A sentence, when there is no such check.
pub fn run_one(
    subject: &Subject,
    name: &str,
    profile: Option<&str>,
    given: &BTreeMap<String, String>,
) -> Result<Finding, String> {
    let check = find(name).ok_or_else(|| {
        let names: Vec<&str> = CHECKS.iter().map(|check| check.name).collect();
        format!("there is no check `{name}`; there are {}", names.join(", "))
    })?;
    let case = match Case::load(subject, profile, given) {
        Ok(case) => case,
        Err(error) if owner(&error) == check.name => return Ok(Finding::failed(error.to_string())),
        // What is broken is another check's matter; a marker is read before what follows it.
        Err(error) if comes_before(check.name, owner(&error)) => {
            return Ok(Finding::passed("what comes first is as it should be"));
        }
        Err(error) => return Ok(Finding::skipped(format!("it does not load: {error}"))),
    };
    Ok((check.run)(&case).unwrap_or_else(|finding| finding))
}

/// Whether loading comes to `name` before it comes to `broken`.
fn comes_before(name: &str, broken: &str) -> bool {
    let place = |name: &str| {
        ["marker", "exports", "descriptor"]
            .iter()
            .position(|n| *n == name)
    };
    matches!((place(name), place(broken)), (Some(a), Some(b)) if a < b)
}
