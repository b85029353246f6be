use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, Command, CommandFactory};
use clap_mangen::Man;
use htex_files::AtFile;

use crate::Cli;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::output::write_file;

/// Write the manual pages, one for each subcommand.
///
/// `man -l DIR/htex-fit.1` shows one; in a man1 folder of MANPATH, `man htex-fit` finds it.
#[derive(Args)]
pub(crate) struct Manual {
    /// The folder to write to; it is made
    #[arg(value_name = "DIR", value_parser = located::OUTPUT)]
    folder: PathBuf,
}

impl Manual {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        fs::create_dir_all(&self.folder).writing(&self.folder)?;
        let mut command = Cli::command().disable_help_subcommand(true);
        command.build();
        write_pages(&command, &self.folder)?;
        Ok(Exit::SUCCESS)
    }
}

/// The page of a command, and those of its subcommands.
fn write_pages(command: &Command, folder: &Path) -> Result<(), Failure> {
    let page = Man::new(command.clone());
    let file = folder.join(page.get_filename());
    let mut text = Vec::new();
    page.render(&mut text).writing(&file)?;
    write_file(&file, &text)?;
    for subcommand in command.get_subcommands().filter(|one| !one.is_hide_set()) {
        write_pages(subcommand, folder)?;
    }
    Ok(())
}
