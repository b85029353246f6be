use std::ffi::OsString;

use clap::Args;
use htex_check::device::{Subject, check, run_one};
use htex_check::harness::Finding;
use htex_device::Origin;

use crate::checking::CheckArgs;
use crate::devices::OneDeviceArgs;
use crate::failure::{Exit, Failure, Result};
use crate::output::{command_line, print_json};

/// Check a device against the rules of the device ABI; exit status 1 if the device breaks a rule.
///
/// Each check runs in its own process, so that a crash or an endless loop ends only that check. The
/// checks drive an output at a hundredth of its limit. They also send samples beyond the limit, to
/// test that the output refuses such samples. Do not touch the connected hardware during the
/// checks.
#[derive(Args)]
pub(crate) struct Check {
    #[command(flatten)]
    device: OneDeviceArgs,

    #[command(flatten)]
    checking: CheckArgs,
}

/// Run one check and print its finding as JSON (internal; `check` starts it).
#[derive(Args)]
pub(crate) struct CheckOne {
    #[command(flatten)]
    device: OneDeviceArgs,
    name: String,
}

impl Check {
    pub(crate) fn run(self) -> Result {
        let Self { device, checking } = self;
        if let Some(name) = &checking.reproduce {
            return checking.print_one(name, &finding(&device, name)?);
        }
        // The settings are read here, so that a wrong setting or an unknown device is reported once
        // and not by each check.
        device.settings.given()?;
        let subject = subject(&device)?;
        let mut arguments = vec!["device".into(), "check-one".into()];
        arguments.extend(device.again());
        let report = check(&device.device, &subject, &checking.runner(arguments)?);
        let again = |name: &str| {
            let mut arguments = device.again();
            arguments.extend(["--reproduce", name].map(OsString::from));
            format!("htex device check {}", command_line(&arguments))
        };
        checking.print_report(&report, again)
    }
}

impl CheckOne {
    pub(crate) fn run(self) -> Result {
        print_json(&finding(&self.device, &self.name)?)?;
        Ok(Exit::SUCCESS)
    }
}

/// Finds the device. If the user named a library file, does not load it, because loading may crash.
/// ([`OneDeviceArgs::load`] loads it.)
fn subject(device: &OneDeviceArgs) -> Result<Subject> {
    if let Some(file) = device.file() {
        return Ok(Subject::Library(file.to_owned()));
    }
    let found = device.find(&device.devices.devices_quietly()?)?;
    Ok(match found.origin {
        Origin::Library(path) => Subject::Library(path),
        Origin::Builtin => Subject::Builtin(found.adapter),
    })
}

/// Runs one check in this process.
fn finding(device: &OneDeviceArgs, name: &str) -> Result<Finding> {
    let (profile, given) = (device.settings.profile(), device.settings.given()?);
    run_one(&subject(device)?, name, profile, &given)
        .map_err(|error| Failure::Usage(error.to_string()))
}
