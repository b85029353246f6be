//! The checker of sources: one check for each guarantee of the source ABI, as for devices.
//!
//! A source is called as a recording calls it, through [`SourceAdapter`]; checks of a library's exports are skipped for one that is
//! built in.

mod case;
mod describe;
mod read;
mod table;

use std::collections::BTreeMap;
use std::fmt::{self, Display};

use htex_check_runner::{Finding, Runner, UnknownCheck, run_all};
use htex_device::SourceAdapter;
use serde::Serialize;

use crate::checks::describe::owner;
use case::Case;

pub use table::CHECKS;

/// The source under test.
pub type Subject = crate::Subject<dyn SourceAdapter>;

pub type Report = htex_check_runner::Report<SourceName>;

/// The source that was checked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SourceName {
    /// A file or an id.
    pub source: String,
}

impl Display for SourceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.source)
    }
}

/// Runs all checks of `source`, each in a process of its own. `runner` is a program that calls [`run_one`]; it gets its own
/// arguments, which name the source and its settings, then the check's name.
pub fn check(source: &str, runner: &Runner) -> Report {
    let checks = run_all(CHECKS, runner, |command, name| {
        command.arg(name);
    });
    let subject = SourceName {
        source: source.to_owned(),
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
