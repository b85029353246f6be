use clap::Args;

use super::LibraryArg;
use super::listing::Listing;
use crate::failure::{Exit, Result, for_file};
use crate::output::note;

/// List the textures of a library: name, size, recorded speeds and forces, law, models, tags.
///
/// The law of a texture describes how the texture changes at speeds and forces that were not
/// recorded. The command prints the law as three exponents, e.g. `f^1 v^0 F^1`. The exponent of f
/// states how the frequencies depend on the speed. The exponent of v states how the level depends
/// on the speed. The exponent of F states how the level depends on the force.
///
/// The command reads only the index of the library.
#[derive(Args)]
pub(crate) struct Ls {
    /// Path or URI of the library
    #[arg(value_parser = LibraryArg::parser())]
    library: LibraryArg,

    /// Print JSON: an array of objects
    #[arg(long)]
    json: bool,
}

impl Ls {
    pub(crate) fn run(self) -> Result {
        let file = self.library.shown();
        let _waiting = self.library.waiting()?;
        let library = self.library.open()?;
        note(&library.notes().iter().map(ToString::to_string).collect::<Vec<_>>());
        let mut listing = Listing::new(self.json);
        for entry in library.entries() {
            listing.add(&entry.map_err(for_file(&file))?)?;
        }
        listing.finish()?;
        Ok(Exit::SUCCESS)
    }
}
