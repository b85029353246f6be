use std::path::PathBuf;

use clap::Args;
use htex_library::Library;

use super::listing::Listing;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::note;

/// List the textures of a library: name, bytes, recorded speeds and forces, models, tags.
///
/// Only the index is read.
#[derive(Args)]
pub(crate) struct Ls {
    /// The library
    library: PathBuf,

    /// Print JSON: an array of objects
    #[arg(long)]
    json: bool,
}

impl Ls {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let failed = |error| Failure::library(&self.library, error);
        let library = Library::open(&self.library).map_err(failed)?;
        note(
            &library
                .notes()
                .iter()
                .map(ToString::to_string)
                .collect::<Vec<_>>(),
        );
        let mut listing = Listing::new(self.json);
        for entry in library.entries() {
            listing.add(&entry.map_err(failed)?)?;
        }
        listing.finish()?;
        Ok(Exit::SUCCESS)
    }
}
