//! The subcommand `htex source` for inputs that deliver samples.

mod check;
mod info;

use clap::{Args, Subcommand};

use crate::failure::{Exit, Failure};

/// Inspect and check recording sources
///
/// `htex record` records from a source; `htex device list` lists them.
#[derive(Args)]
pub(crate) struct Source {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Info(info::Info),
    Check(check::Check),
    #[command(hide = true)]
    CheckOne(check::CheckOne),
}

impl Source {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        match self.command {
            Command::Info(args) => args.run(),
            Command::Check(args) => args.run(),
            Command::CheckOne(args) => args.run(),
        }
    }
}
