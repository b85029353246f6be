use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};

use clap::Args;
use htex_lab::study::{FeltSpectra, export};
use serde::{Serialize, Serializer};
use serde_json::json;

use super::spectra::SpectraArgs;
use crate::failure::Result;
use crate::located;
use crate::output::{show, shown, warn, write_file};

/// Write a table of all participants' ratings, and a table of the spectra that the participants
/// felt.
///
/// The table of ratings has the columns participant, texture, model, repetition, rating, attribute,
/// hidden_reference, response_ms, gain_db, simulated and off_target. The column off_target states
/// whether speed or force differed from the study's target by more than 10 %. Without measurements
/// of speed and force, the column is empty. The table of spectra has the columns participant,
/// texture and model, and a column with the magnitude at each of the frequencies 20, 25, …, 1000
/// Hz.
#[derive(Args)]
pub(crate) struct Export {
    /// Folder with the answers, as written by `htex study run`
    folder: PathBuf,

    /// The table of ratings to write, CSV
    #[arg(short, long, value_name = "CSV", value_parser = located::OUTPUT)]
    output: PathBuf,

    /// Write the ratings of this attribute; needed if the study has several attributes
    #[arg(long, value_name = "NAME")]
    attribute: Option<String>,

    #[command(flatten)]
    spectra: SpectraArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Export {
    pub(crate) fn run(self) -> Result {
        let table = export(&self.folder, self.attribute.as_deref())?;
        warn(&table.warnings);
        // The ratings are written first, so that a problem with a recording does not lose them.
        write_file(&self.output, table.csv.as_bytes())?;
        let spectra = self.spectra.table(&self.folder)?;
        if let Some((file, spectra)) = &spectra {
            warn(&spectra.warnings);
            write_file(file, spectra.csv.as_bytes())?;
        }
        show(&Tables { args: &self, table, spectra }, self.json)
    }
}

/// The tables that were written.
struct Tables<'a> {
    args: &'a Export,
    table: htex_lab::study::Export,
    spectra: Option<(&'a Path, FeltSpectra)>,
}

impl Serialize for Tables<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        json!({
            "participants": self.table.participants,
            "ratings": self.table.ratings,
            "incomplete": self.table.incomplete,
            "off_target": self.table.off_target,
            "recordings": self.spectra.as_ref().map(|(_, spectra)| spectra.recordings),
        })
        .serialize(serializer)
    }
}

impl Display for Tables<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        if let Some((file, spectra)) = &self.spectra {
            writeln!(f, "{}: spectra of {} recordings", shown(file), spectra.recordings)?;
        }
        let (participants, ratings) = (self.table.participants, self.table.ratings);
        let file = shown(&self.args.output);
        writeln!(f, "{file}: {ratings} ratings of {participants} participants")
    }
}
