use clap::{Args, ValueEnum};
use htex_check::templates;

use crate::failure::Result;
use crate::project::NewProject;

/// Write a project for a new device. The project builds with one command. Its device is an output
/// that writes the samples to a file, and passes `htex device check`.
#[derive(Args)]
pub(crate) struct New {
    #[command(flatten)]
    project: NewProject,

    /// Language of the project
    #[arg(long, value_enum)]
    lang: Lang,
}

#[derive(Clone, Copy, ValueEnum)]
enum Lang {
    Rust,
    C,
}

impl New {
    pub(crate) fn run(self) -> Result {
        self.project.write(match self.lang {
            Lang::Rust => &templates::DEVICE_RUST,
            Lang::C => &templates::DEVICE_C,
        })
    }
}
