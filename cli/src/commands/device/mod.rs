//! The subcommand `htex device`.

mod check;
mod info;
mod list;
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
        Check(check::Check),
        New(new::New),
        #[command(hide = true)]
        CheckOne(check::CheckOne),
    }
}

impl Device {
    pub(crate) fn run(self) -> Result {
        self.command.run()
    }
}
