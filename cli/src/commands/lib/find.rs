use clap::Args;
use htex_format::library::Query;

use super::LibraryArg;
use super::listing::Listing;
use crate::failure::{Exit, Result, for_file};
use crate::output::note;

/// Search a library: list the textures that match all given words and options.
#[derive(Args)]
pub(crate) struct Find {
    /// Path or URI of the library
    #[arg(value_parser = LibraryArg::parser())]
    library: LibraryArg,

    /// List only textures whose name or tags contain all these words, ignoring case
    words: Vec<String>,

    /// List only textures that have exactly this tag, ignoring case; may be given several times
    #[arg(long)]
    tag: Vec<String>,

    /// List only textures with this speed in the range of their recorded speeds, mm/s
    #[arg(long, value_name = "MM_S", value_parser = not_negative)]
    speed: Option<f64>,

    /// List only textures with this normal force in the range of their recorded forces, newtons
    #[arg(long, value_name = "N", value_parser = not_negative)]
    force: Option<f64>,

    /// List only textures that have the model with this id. The last part of the id is enough, e.g.
    /// ar
    #[arg(long, value_name = "ID")]
    model: Option<String>,

    /// Print JSON: an array of objects
    #[arg(long)]
    json: bool,
}

impl Find {
    pub(crate) fn run(self) -> Result {
        let file = self.library.shown();
        let library = self.library.open()?;
        let query = Query {
            words: self.words.clone(),
            tags: self.tag.clone(),
            speed_mm_s: self.speed,
            force_n: self.force,
            model: self.model.clone(),
        };
        let mut listing = Listing::new(self.json);
        for entry in library.entries() {
            let entry = entry.map_err(for_file(&file))?;
            if query.matches(&entry) {
                listing.add(&entry)?;
            }
        }
        if listing.finish()? == 0 {
            note(&["no texture of the library has all of this"]);
        }
        Ok(Exit::SUCCESS)
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
    number.ok_or_else(|| "it must be a number that is finite and not negative".to_owned())
}
