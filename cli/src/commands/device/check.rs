use clap::Args;
use htex_device::Adapter;

use crate::adapter_checks::Checked;
use crate::checking::CheckArgs;
use crate::devices::{DeviceArgs, SettingArgs};
use crate::failure::{Exit, Failure};

/// Check that a device keeps every promise of the device ABI; exit status 1 if it does not.
///
/// Each check runs in its own process, so that a crash or an endless loop ends only that check. The
/// checks drive the device at a hundredth of its limit, and offer it samples beyond the limit,
/// which it must refuse. Do not touch what is connected.
#[derive(Args)]
pub(crate) struct Check {
    #[command(flatten)]
    which: Which,

    #[command(flatten)]
    checking: CheckArgs,
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
    fn checked(&self) -> Result<Checked<'_, dyn Adapter>, Failure> {
        Ok(Checked {
            name: &self.device,
            subject: self.devices.subject(&self.device)?,
            places: self.devices.again(),
            settings: &self.settings,
        })
    }
}

impl Check {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        self.which.checked()?.run(&self.checking)
    }
}

impl CheckOne {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        self.which.checked()?.print_one(&self.name)
    }
}
