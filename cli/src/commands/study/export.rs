use std::path::PathBuf;

use clap::Args;
use htex_lab::study::export;
use serde_json::json;

use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::output::{print, print_json, warn, write_file};
use crate::shown::shown;

use super::spectra::SpectraArgs;

/// Write the ratings of all participants as a table, and the spectra of what they felt as another.
///
/// The columns of the table are participant, texture, model, repetition, rating, attribute,
/// hidden_reference, response_ms, gain_db, simulated and off_target (whether speed or force left
/// the study's target by more than 10 %; empty if neither was measured). The columns of the spectra
/// are participant, texture, model, and a magnitude for 20, 25, …, 1000 Hz.
#[derive(Args)]
pub(super) struct Export {
    /// The folder of answers, written by `htex study run`
    folder: PathBuf,

    /// The table to write, CSV
    #[arg(short, long, value_name = "CSV", value_parser = located::OUTPUT)]
    output: PathBuf,

    /// The attribute whose ratings are written, if there are several
    #[arg(long, value_name = "NAME")]
    attribute: Option<String>,

    #[command(flatten)]
    spectra: SpectraArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Export {
    pub(super) fn run(self) -> Result<Exit, Failure> {
        let table = export(&self.folder, self.attribute.as_deref())?;
        warn(&table.warnings);
        // The ratings are written first, so that a problem with a recording does not lose them.
        write_file(&self.output, table.csv.as_bytes())?;
        let spectra = self.spectra.table(&self.folder)?;
        if let Some((file, spectra)) = &spectra {
            warn(&spectra.warnings);
            write_file(file, spectra.csv.as_bytes())?;
        }
        let (participants, ratings) = (table.participants, table.ratings);
        if self.json {
            print_json(&json!({
                "participants": participants,
                "ratings": ratings,
                "incomplete": table.incomplete,
                "off_target": table.off_target,
                "recordings": spectra.as_ref().map(|(_, spectra)| spectra.recordings),
            }))?;
        } else {
            if let Some((file, spectra)) = &spectra {
                print(&format!("{}: spectra of {} recordings\n", shown(file), spectra.recordings))?;
            }
            print(&format!(
                "{}: {ratings} ratings of {participants} participants\n",
                shown(&self.output)
            ))?;
        }
        Ok(Exit::SUCCESS)
    }
}
