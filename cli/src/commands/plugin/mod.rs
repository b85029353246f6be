//! `htex plugin`: what model authors and their users need.

mod check;

use std::process::ExitCode;

use clap::{Args, Subcommand};

use crate::failure::Failure;

/// Check texture models.
#[derive(Args)]
pub(crate) struct Plugin {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Check(check::Check),
    #[command(hide = true)]
    CheckOne(check::CheckOne),
}

impl Plugin {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        match self.command {
            Command::Check(args) => args.run(),
            Command::CheckOne(args) => args.run(),
        }
    }
}
