//! The subcommand `htex plugin` for authors and users of models.

mod bench;
mod check;
mod info;
mod list;
mod named;
mod new;

use clap::{Args, Subcommand};

use crate::exit::Exit;
use crate::failure::Failure;

/// Inspect, check and time texture models
#[derive(Args)]
pub(crate) struct Plugin {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    List(list::List),
    Info(info::Info),
    Check(check::Check),
    New(new::New),
    Bench(bench::Bench),
    #[command(hide = true)]
    CheckOne(check::CheckOne),
}

impl Plugin {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        match self.command {
            Command::List(args) => args.run(),
            Command::Info(args) => args.run(),
            Command::Check(args) => args.run(),
            Command::New(args) => args.run(),
            Command::Bench(args) => args.run(),
            Command::CheckOne(args) => args.run(),
        }
    }
}
