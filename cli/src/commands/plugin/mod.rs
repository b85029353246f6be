//! The subcommand `htex plugin` for authors and users of models.

#[cfg(feature = "check")]
mod bench;
#[cfg(feature = "build")]
mod candidate;
#[cfg(feature = "check")]
mod check;
mod export;
mod info;
#[cfg(feature = "build")]
mod install;
mod list;
#[cfg(feature = "check")]
mod new;
#[cfg(feature = "build")]
mod remove;
#[cfg(feature = "build")]
mod update;

use clap::Args;

#[cfg(feature = "build")]
pub(in crate::commands) use candidate::first_bad;

use super::subcommands;
use crate::failure::Result;

/// Find, write, check, install and time plugins
#[derive(Args)]
pub(crate) struct Plugin {
    #[command(subcommand)]
    command: Command,
}

subcommands! {
    Command {
        List(list::List),
        Info(info::Info),
        Check(check::Check) if feature = "check",
        Install(install::Install) if feature = "build",
        Remove(remove::Remove) if feature = "build",
        Update(update::Update) if feature = "build",
        Export(export::Export),
        New(new::New) if feature = "check",
        Bench(bench::Bench) if feature = "check",
        #[command(hide = true)]
        CheckOne(check::CheckOne) if feature = "check",
    }
}

impl Plugin {
    pub(crate) fn run(self) -> Result {
        self.command.run()
    }
}
