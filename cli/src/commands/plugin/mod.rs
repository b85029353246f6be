//! The subcommand `htex plugin` for authors and users of models.

mod bench;
mod check;
mod export;
mod info;
mod list;
mod new;

use clap::Args;

use super::subcommands;
use crate::failure::Result;

/// Inspect, check and time texture models
#[derive(Args)]
pub(crate) struct Plugin {
    #[command(subcommand)]
    command: Command,
}

subcommands! {
    Command {
        List(list::List),
        Info(info::Info),
        Check(check::Check),
        Export(export::Export),
        New(new::New),
        Bench(bench::Bench),
        #[command(hide = true)]
        CheckOne(check::CheckOne),
    }
}

impl Plugin {
    pub(crate) fn run(self) -> Result {
        self.command.run()
    }
}
