//! The subcommand `htex conformance` for authors of readers and players.

mod answer;
mod run;

use clap::Args;

use super::subcommands;
use crate::failure::Result;

/// Test third-party readers and players
///
/// The specification comes with several hundred test files. For each file, the specification says
/// what a reader must find in the file, or which numbers a player must compute from the file. `htex
/// conformance run` starts your program once for each file, and counts the correct answers.
/// `spec/conformance-protocol.md` says what your program must print.
#[derive(Args)]
pub(crate) struct Conformance {
    #[command(subcommand)]
    command: Command,
}

subcommands! {
    Command {
        Run(run::Run),
        Answer(answer::Answer),
    }
}

impl Conformance {
    pub(crate) fn run(self) -> Result {
        self.command.run()
    }
}
