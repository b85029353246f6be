use clap::Args;
use htex_device::guardian::hold;

use crate::devices::DeviceArgs;
use crate::failure::{Exit, Result};

/// Open a device for the process that started this command, and set the device's output to zero
/// when that process ends (internal; `htex play` starts this command).
#[derive(Args)]
#[command(hide = true)]
pub(crate) struct Guard {
    #[command(flatten)]
    devices: DeviceArgs,
}

impl Guard {
    pub(crate) fn run(self) -> Result {
        // Only the end of the pipe ends this process.
        crate::signals::ignore();
        let devices = self.devices.devices_quietly()?;
        let (from, to) = (std::io::stdin().lock(), std::io::stdout().lock());
        hold(|id| devices.find_output(id).cloned(), from, to);
        Ok(Exit::SUCCESS)
    }
}
