//! The subcommand `htex study` for studies in which people rate textures.

mod asker;
mod clock;
mod elsewhere;
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

use std::path::Path;

use clap::{Args, Subcommand};
use htex_base::files::AtFile;
use htex_base::finding::Findings;
use htex_lab::study::{Study as File, read_study};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::shown::shown;

/// Plan, run and analyse rating studies
///
/// study.toml describes a study (its JSON Schema: `htex schema study`). The defaults are those of
/// the paper's study.
#[derive(Args)]
pub(crate) struct Study {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Validate(validate::Validate),
    Plan(plan::Plan),
    Run(Box<run::Run>),
    Export(export::Export),
    /// Analyse the ratings of a study, and what was felt; by the Python package
    /// (`pip install htex[lab]`)
    Analyse(elsewhere::Elsewhere),
    /// Find out how many participants a study needs; by the Python package
    /// (`pip install htex[lab]`)
    Power(elsewhere::Elsewhere),
}

impl Study {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        match self.command {
            Command::Validate(args) => args.run(),
            Command::Plan(args) => args.run(),
            Command::Run(args) => args.run(),
            Command::Export(args) => args.run(),
            Command::Analyse(args) | Command::Power(args) => args.run(),
        }
    }
}

/// The message for findings that prevent a study from running.
const CANNOT_RUN: &str = "this study cannot be run";

/// Reads a study, which must be valid. Does not read the files that it names.
fn open(file: &Path) -> Result<File, Failure> {
    let bytes = std::fs::read(file).reading(file)?;
    let mut findings = Findings::default();
    read_study(&bytes, &mut findings).ok_or_else(|| Failure::Findings {
        cannot: CANNOT_RUN,
        file: shown(file),
        findings: findings.into_list(),
    })
}
