//! `htex study`: people rate textures.

mod analyse;
mod power;

use clap::{Args, Subcommand};

use crate::exit::Exit;
use crate::failure::Failure;

/// Rating studies: get their results, and find out how many people they need.
#[derive(Args)]
pub(crate) struct Study {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Analyse(analyse::Analyse),
    Power(power::Power),
}

impl Study {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        match self.command {
            Command::Analyse(args) => args.run(),
            Command::Power(args) => args.run(),
        }
    }
}
