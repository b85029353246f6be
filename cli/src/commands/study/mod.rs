//! The subcommand `htex study` for studies in which people rate textures.

mod asker;
mod clock;
mod export;
mod felt;
#[cfg(unix)]
mod keys;
mod plan;
mod rig;
mod run;
mod spectra;
mod terminal;
mod validate;

use std::ffi::OsString;
use std::path::Path;

use clap::Args;
use htex_base::files::AtFile;
use htex_base::finding::{Finding, Findings};
use htex_lab::study::{Study as File, read_study};

use super::subcommands;
use crate::failure::{Failure, Result};

/// Plan, run and analyse rating studies
///
/// A file such as study.toml describes a study. `htex schema study` prints the JSON Schema of such
/// files. The default values come from the study in the paper.
#[derive(Args)]
pub(crate) struct Study {
    #[command(subcommand)]
    command: Command,
}

subcommands! {
    Command {
        Validate(validate::Validate),
        Plan(plan::Plan),
        Run(Box<run::Run>),
        Export(export::Export),
        /// Analyse the ratings of a study and what participants felt; needs the Python package
        /// (`pip install htex[lab]`)
        Analyse(PythonCommand),
        /// Find out how many participants a study needs; needs the Python package
        /// (`pip install htex[lab]`)
        Power(PythonCommand),
    }
}

impl Study {
    pub(crate) fn run(self) -> Result {
        self.command.run()
    }
}

/// A subcommand that only the `htex` command of the Python package implements. In this program, the
/// subcommand only prints an error.
#[derive(Args)]
#[command(disable_help_flag = true)]
pub(crate) struct PythonCommand {
    /// Accepts any arguments, so that every call of the subcommand leads to the same error.
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<OsString>,
}

impl PythonCommand {
    fn run(self) -> Result {
        Err(Failure::usage(
            "this program has no statistics; `pip install htex[lab]` brings a command `htex` that has them, with the same arguments",
        ))
    }
}

/// Reports findings that prevent a study from running.
fn cannot_run(file: &Path, findings: Vec<Finding>) -> Failure {
    Failure::Findings { cannot: "this study cannot be run", findings }.in_file(file)
}

/// Reads a study, which must be valid. Does not read the files that it names.
fn open(file: &Path) -> Result<File> {
    let bytes = std::fs::read(file).reading(file)?;
    let mut findings = Findings::default();
    read_study(&bytes, &mut findings).ok_or_else(|| cannot_run(file, findings.into_list()))
}
