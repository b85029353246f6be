use std::io::IsTerminal;
use std::path::PathBuf;

use clap::Args;

use super::LibraryArg;
use crate::failure::{Exit, Failure, Result, for_file};
use crate::located;
use crate::output::{write_bytes, write_file};
use crate::outputs::check_outputs;

/// Extract one texture from a library. The extracted .htex file is identical, byte for byte, to the
/// file that was packed.
#[derive(Args)]
pub(crate) struct Cat {
    /// Path or URI of the library
    #[arg(value_parser = LibraryArg::parser())]
    library: LibraryArg,

    /// Name of the texture, as printed by `htex lib ls`
    name: String,

    /// The file to write [default: standard output]
    #[arg(short, long, value_name = "HTEX", value_parser = located::OUTPUT)]
    output: Option<PathBuf>,
}

impl Cat {
    pub(crate) fn run(self) -> Result {
        check_outputs(self.output.as_deref(), self.library.local())?;
        if self.output.is_none() && std::io::stdout().is_terminal() {
            return Err(Failure::usage("a texture is not text; name a file for it with -o"));
        }
        let _waiting = self.library.waiting()?;
        let library = self.library.open()?;
        let bytes = library.get(&self.name).map_err(for_file(&self.library.shown()))?;
        match &self.output {
            Some(output) => write_file(output, &bytes)?,
            None => write_bytes(&bytes)?,
        }
        Ok(Exit::SUCCESS)
    }
}
