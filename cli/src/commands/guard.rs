use clap::Args;
use htex_device::guardian::hold;

use crate::devices::DeviceArgs;
use crate::failure::{Exit, Result};

/// Hold a device's output for the process that started this one (internal; `htex play` starts it).
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
