use std::path::Path;

use clap::Args;
use htex_author::{TextureSpectrum, describe, segment_take};
use htex_base::finding::plain;
use htex_format::library::{CoarseSpectrum, Entry, Library, LibraryFile, Query, split_address};
use htex_format::{Asset, Quantity};
use serde::Serialize;

use super::LibraryArg;
use super::listing::{Listing, row};
use crate::commands::validate::{Kind, kind};
use crate::failure::{Exit, Failure, Result, for_file};
use crate::output::{note, shown};
use crate::recordings::RecordingArgs;

/// Search a library: list the textures that match all given words and options
///
/// With --like, the command lists the textures whose spectra are most similar to the spectrum of
/// the given texture, with their distance in decibels. The distance is the RMS difference of the
/// levels at 48 frequencies from 20 to 1000 Hz, at the default condition of each texture. The
/// command does not compare spectra of different quantities, such as force and acceleration.
///
/// The command reads only the index of the library. With --like and --duplicates, it also reads the
/// spectra that are stored beside the index.
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

    /// List only textures with this licence, ignoring case; `*` stands for any text, e.g. CC*
    #[arg(long, value_name = "GLOB")]
    license: Option<String>,

    /// List only textures of this author, ignoring case; `*` stands for any text
    #[arg(long, value_name = "GLOB")]
    author: Option<String>,

    /// List only textures of this quantity
    #[arg(long, value_name = "NAME")]
    quantity: Option<Quantity>,

    /// List only textures whose held-out error is known and at most this, decibels
    #[arg(long, value_name = "DB", value_parser = not_negative)]
    max_held_out: Option<f64>,

    /// List only textures whose felt difference from their recordings is known and at most this,
    /// decibels
    #[arg(long, value_name = "DB", value_parser = not_negative)]
    max_felt: Option<f64>,

    /// List the textures that are most similar to this one: a texture of the library, an asset or a
    /// recording
    #[arg(long, value_name = "NAME|FILE")]
    like: Option<String>,

    /// Number of textures to list with --like
    #[arg(short, value_name = "N", default_value = "10", requires = "like")]
    n: u32,

    /// List each texture whose spectrum nearly equals the spectrum of an earlier texture in the
    /// library
    #[arg(long, conflicts_with = "like")]
    duplicates: bool,

    /// Largest distance of duplicates, decibels
    #[arg(long, value_name = "DB", default_value = "0.5", value_parser = not_negative)]
    #[arg(requires = "duplicates")]
    within: f64,

    /// Exit with status 1 if no texture is found
    #[arg(long)]
    exists: bool,

    /// Print JSON: an array of objects
    #[arg(long)]
    json: bool,
}

/// A texture that is near another one.
#[derive(Serialize)]
struct Near<'a> {
    distance_db: f64,
    /// Name of the texture that it nearly equals.
    #[serde(skip_serializing_if = "Option::is_none")]
    duplicate_of: Option<&'a str>,
    #[serde(flatten)]
    entry: &'a Entry,
}

impl Find {
    pub(crate) fn run(self) -> Result {
        let file = self.library.shown();
        let _waiting = self.library.waiting()?;
        let library = self.library.open()?;
        let query = self.query();
        let is_old = library.index().minor_version() == 0;
        if is_old && (query.needs_version_1_1() || self.duplicates || self.like.is_some()) {
            note(&[format!(
                "the index of this library (version 1.0) does not have what you search for; `htex lib pack NEW.htexlib {}` writes one that has",
                shown(&file)
            )]);
        }
        let listing = Listing::new(self.json);
        let found = if let Some(like) = &self.like {
            self.similar(&library, like, &query, listing)?
        } else if self.duplicates {
            let found = library.duplicates(&query, self.within).map_err(for_file(&file))?;
            let mut listing = listing;
            for one in &found {
                let of = &one.of;
                let line = format!(
                    "{:32} = {:32} {:5.2} dB\n",
                    plain(&one.entry.name),
                    plain(of),
                    one.distance_db
                );
                listing.add_line(&near(&one.entry, one.distance_db, Some(of)), &line)?;
            }
            listing.finish()?
        } else {
            let mut listing = listing;
            for entry in library.entries() {
                let entry = entry.map_err(for_file(&file))?;
                if query.matches(&entry) {
                    listing.add(&entry)?;
                }
            }
            listing.finish()?
        };
        if found > 0 {
            return Ok(Exit::SUCCESS);
        }
        note(&["no texture of the library has all of this"]);
        Ok(if self.exists { Exit::FAILURE } else { Exit::SUCCESS })
    }

    fn query(&self) -> Query {
        Query {
            words: self.words.clone(),
            tags: self.tag.clone(),
            speed_mm_s: self.speed,
            force_n: self.force,
            model: self.model.clone(),
            license: self.license.clone(),
            author: self.author.clone(),
            quantity: self.quantity,
            felt_error_rms_db: self.max_felt,
            held_out_error_db: self.max_held_out,
        }
    }

    fn similar(
        &self,
        library: &Library<LibraryFile>,
        like: &str,
        query: &Query,
        mut listing: Listing,
    ) -> Result<u64> {
        let file = self.library.shown();
        let (spectrum, quantity) = spectrum_of(library, &file, like)?;
        let most = usize::try_from(self.n).unwrap_or(usize::MAX);
        let found = library.similar(&spectrum, quantity, query, most).map_err(for_file(&file))?;
        for one in &found {
            let line = format!("{:5.1} dB  {}", one.distance_db, row(&one.entry));
            listing.add_line(&near(&one.entry, one.distance_db, None), &line)?;
        }
        listing.finish()
    }
}

fn near<'a>(entry: &'a Entry, distance_db: f64, of: Option<&'a str>) -> Near<'a> {
    // The distance gets as many digits as the stored spectra have.
    let distance_db = (distance_db * 100.0).round() / 100.0;
    Near { distance_db, duplicate_of: of, entry }
}

/// Returns the spectrum to search for, and its quantity. `like` is the name of a texture of the
/// library, or else a file.
fn spectrum_of(
    library: &Library<LibraryFile>,
    file: &Path,
    like: &str,
) -> Result<(CoarseSpectrum, Quantity)> {
    let silent = || Failure::Other(format!("--like {like}: it has no spectrum to compare"));
    if let Some(entry) = library.entry(like).map_err(for_file(file))? {
        let description = library.description(&entry).map_err(for_file(file))?;
        return description.spectrum.zip(entry.quantity).ok_or_else(silent);
    }
    let path = Path::new(like);
    if split_address(like).is_some() || path.is_file() {
        let (spectrum, quantity) = if split_address(like).is_none() && kind(path) == Kind::Recording
        {
            of_recording(path)?
        } else {
            let asset = Asset::open(path).map_err(for_file(path))?;
            (describe(&asset).spectrum, asset.manifest.quantity)
        };
        return spectrum.map(|spectrum| (spectrum, quantity)).ok_or_else(silent);
    }
    let absent = library.needed(like).map_err(for_file(file));
    absent.and_then(|_| Err(silent()))
}

/// Returns the spectrum of a recording, read with the default settings.
fn of_recording(path: &Path) -> Result<(Option<CoarseSpectrum>, Quantity)> {
    let reading = RecordingArgs::default();
    let options = reading.spectrum_options()?;
    let take = segment_take(&reading.read_one(path)?, &options, false)?;
    let spectrum = TextureSpectrum::average(&[take.spectra], options.averaging)?;
    let coarse = CoarseSpectrum::new(&spectrum.frequency_hz, &spectrum.magnitude);
    Ok((coarse, spectrum.quantity))
}

fn not_negative(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
    number.ok_or_else(|| "it must be a number that is finite and not negative".to_owned())
}
