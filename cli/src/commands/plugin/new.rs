use clap::{Args, ValueEnum};
use htex_check::templates;

use crate::failure::Result;
use crate::project::NewProject;

/// Write a project for a new model. The project builds with one command, and its model passes
/// `htex plugin check`.
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
    Zig,
}

impl New {
    pub(crate) fn run(self) -> Result {
        self.project.write(match self.lang {
            Lang::Rust => &templates::MODEL_RUST,
            Lang::C => &templates::MODEL_C,
            Lang::Zig => &templates::MODEL_ZIG,
        })
    }
}
