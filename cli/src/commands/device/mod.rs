//! The subcommand `htex device`.

mod check;
mod info;
mod list;

use clap::{Args, Subcommand};

use crate::failure::{Exit, Failure};

/// List, inspect and check devices
#[derive(Args)]
pub(crate) struct Device {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    List(list::List),
    Info(info::Info),
    Check(check::Check),
    #[command(hide = true)]
    CheckOne(check::CheckOne),
}

impl Device {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        match self.command {
            Command::List(args) => args.run(),
            Command::Info(args) => args.run(),
            Command::Check(args) => args.run(),
            Command::CheckOne(args) => args.run(),
        }
    }
}
