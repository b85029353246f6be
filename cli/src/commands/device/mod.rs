//! The subcommand `htex device`.

#[cfg(feature = "check")]
mod check;
mod info;
mod list;
#[cfg(feature = "check")]
mod new;

use clap::Args;

use super::subcommands;
use crate::failure::Result;

/// List, inspect, check and create devices
#[derive(Args)]
pub(crate) struct Device {
    #[command(subcommand)]
    command: Command,
}

subcommands! {
    Command {
        List(list::List),
        Info(info::Info),
        Check(check::Check) if feature = "check",
        New(new::New) if feature = "check",
        #[command(hide = true)]
        CheckOne(check::CheckOne) if feature = "check",
    }
}

impl Device {
    pub(crate) fn run(self) -> Result {
        self.command.run()
    }
}
