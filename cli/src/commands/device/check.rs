use std::process::ExitCode;

use clap::Args;
use htex_check::Finding;
use htex_device_check::{Options, check, run_one};

use crate::checking::{exit_code, tell_one, this_program, timeout};
use crate::devices::{DeviceArgs, SettingArgs};
use crate::failure::Failure;
use crate::output::{print, print_json};

/// Check that a device keeps every promise of the device ABI; exit status 1 if it does not.
///
/// Each check runs in a process of its own, so that a crash or an endless loop is an answer too. The
/// device is driven at a hundredth of its limit, and offered samples beyond it, which it must refuse:
/// touch nothing that is connected.
#[derive(Args)]
pub(crate) struct Check {
    #[command(flatten)]
    which: Which,

    /// Print JSON
    #[arg(long)]
    json: bool,

    /// How long one check may take, s
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    timeout: f64,

    /// Run this one check in a single process, e.g. under a debugger
    #[arg(long, value_name = "NAME", conflicts_with = "timeout")]
    reproduce: Option<String>,
}

/// Run one check and print its finding as JSON: what `check` starts.
#[derive(Args)]
pub(crate) struct CheckOne {
    #[command(flatten)]
    which: Which,
    name: String,
}

/// A device, and how it is set.
#[derive(Args)]
struct Which {
    /// The device, by short name, id or library file
    #[arg(value_name = "FILE|ID")]
    device: String,

    #[command(flatten)]
    devices: DeviceArgs,

    #[command(flatten)]
    settings: SettingArgs,
}

impl Which {
    fn run_one(&self, name: &str) -> Result<Finding, Failure> {
        let subject = self.devices.subject(&self.device)?;
        let given = self.settings.given()?;
        run_one(&subject, name, self.settings.profile(), &given).map_err(Failure::Usage)
    }
}

impl Check {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        if let Some(name) = &self.reproduce {
            let finding = self.which.run_one(name)?;
            return tell_one(name, &finding, self.json);
        }
        // A wrong name is told once, not by each check.
        self.which.devices.subject(&self.which.device)?;
        self.which.settings.given()?;
        let report = check(&self.which.device, &self.options()?);
        if self.json {
            print_json(&report)?;
        } else {
            print(&report.to_text())?;
        }
        Ok(exit_code(!report.ok))
    }

    fn options(&self) -> Result<Options, Failure> {
        let mut arguments = vec!["device".into(), "check-one".into()];
        arguments.extend(self.which.devices.again());
        arguments.extend(self.which.settings.again());
        arguments.push(self.which.device.clone().into());
        Ok(Options {
            program: this_program()?,
            arguments,
            timeout: timeout(self.timeout)?,
        })
    }
}

impl CheckOne {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        print_json(&self.which.run_one(&self.name)?)?;
        Ok(ExitCode::SUCCESS)
    }
}
