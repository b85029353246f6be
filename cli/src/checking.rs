//! The common part of the commands that check models and devices.

use std::fmt::Display;
use std::time::Duration;

use clap::Args;
use htex_check::harness::{Finding, Report, Runner};
use serde::Serialize;

use crate::failure::{Exit, Failure, Result};
use crate::invocation;
use crate::output::{print, print_json, show};

/// Options of the commands that check models and devices.
#[derive(Args)]
pub(crate) struct CheckArgs {
    /// Print JSON
    #[arg(long)]
    json: bool,

    /// Time limit of each check, s
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    timeout: f64,

    /// Run only the check NAME, in this process instead of a separate one, so that a debugger can
    /// follow the check
    #[arg(long, value_name = "NAME", conflicts_with = "timeout")]
    pub(crate) reproduce: Option<String>,
}

impl CheckArgs {
    /// Returns a runner that starts this program for each check. These arguments come before the
    /// check's own arguments.
    pub(crate) fn runner(
        &self,
        arguments: impl IntoIterator<Item = std::ffi::OsString>,
    ) -> Result<Runner> {
        let program = invocation::program()?;
        Ok(Runner {
            program: program.file.into(),
            arguments: program.arguments.into_iter().chain(arguments).collect(),
            timeout: timeout(self.timeout)?,
        })
    }

    /// Prints the finding of a single check.
    pub(crate) fn print_one(&self, name: &str, finding: &Finding) -> Result {
        if self.json {
            print_json(finding)?;
        } else {
            let word = finding.outcome.word();
            print(&format!("{name}: {word}: {}\n", finding.message))?;
        }
        Ok(Exit::ok_if(!finding.outcome.is_bad()))
    }

    /// Prints a report. `again` returns the command that runs the check with this name again, in
    /// one process.
    pub(crate) fn print_report<Subject: Display + Serialize>(
        &self,
        report: &Report<Subject>,
        again: impl Fn(&str) -> String,
    ) -> Result {
        show(report, self.json)?;
        if let (Some(first), false) = (report.bad().first(), self.json) {
            print(&format!("again, in one process: {}\n", again(first)))?;
        }
        Ok(Exit::ok_if(report.ok))
    }
}

fn timeout(seconds: f64) -> Result<Duration> {
    Duration::try_from_secs_f64(seconds)
        .ok()
        // The end of a check is `Instant::now() + timeout`, which must not overflow.
        .filter(|timeout| !timeout.is_zero() && timeout.as_secs() < 1_000_000)
        .ok_or_else(|| Failure::Usage(format!("--timeout {seconds}: seconds, more than 0")))
}
