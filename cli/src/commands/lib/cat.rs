use std::io::IsTerminal;
use std::path::PathBuf;

use clap::Args;
use htex_library::Library;

use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::{write_bytes, write_file};
use crate::outputs::check_outputs;

/// Take one texture out of a library: its .htex file, byte for byte.
#[derive(Args)]
pub(crate) struct Cat {
    /// The library
    library: PathBuf,

    /// Name of the texture, as `htex lib ls` prints it
    name: String,

    /// The file to write [default: standard output]
    #[arg(short, long, value_name = "HTEX")]
    output: Option<PathBuf>,
}

impl Cat {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        check_outputs(self.output.as_deref(), [self.library.as_path()])?;
        if self.output.is_none() && std::io::stdout().is_terminal() {
            let sentence = "a texture is not text; name a file for it with -o";
            return Err(Failure::Usage(sentence.to_owned()));
        }
        let failed = |error| Failure::library(&self.library, error);
        let library = Library::open(&self.library).map_err(failed)?;
        let bytes = library.get(&self.name).map_err(failed)?;
        match &self.output {
            Some(output) => write_file(output, &bytes)?,
            None => write_bytes(&bytes)?,
        }
        Ok(Exit::SUCCESS)
    }
}
