use std::io::Write;
use std::path::PathBuf;

use clap::{Args, Command};
use clap_mangen::Man;
use htex_base::files::{AtFile, OwnFolder};

use crate::failure::{Exit, Result};

/// Write the manual pages
///
/// Writes one manual page for each subcommand.
///
/// `man -l DIR/htex-fit.1` shows one page. `man htex-fit` finds the page if DIR is the subfolder
/// man1 of a folder in MANPATH.
#[derive(Args)]
pub(crate) struct Manual {
    /// Folder to write to; created if it does not exist
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

impl Manual {
    pub(crate) fn run(self) -> Result {
        // Otherwise there would be a page for the `help` of each subcommand.
        let mut command = crate::command().disable_help_subcommand(true);
        // Gives subcommands their full names, such as `htex-fit`, which name the files.
        command.build();
        write_pages(&command, &OwnFolder::new(&self.folder))?;
        Ok(Exit::SUCCESS)
    }
}

/// Writes the page of a command and the pages of its subcommands.
fn write_pages(command: &Command, folder: &OwnFolder) -> Result<()> {
    let page = Man::new(command.clone());
    let name = PathBuf::from(page.get_filename());
    let file = folder.path().join(&name);
    let mut text = Vec::new();
    page.render(&mut text).writing(&file)?;
    let write = |into: &mut std::fs::File| into.write_all(&text);
    folder.replace(&name, write).writing(&file)?;
    for subcommand in command.get_subcommands().filter(|one| !one.is_hide_set()) {
        write_pages(subcommand, folder)?;
    }
    Ok(())
}
