//! The table of the spectra that participants felt.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use htex_author::settings::ReadingSettings;
use htex_lab::study::{FeltSpectra, OffTarget, Reference, felt_spectra};

use super::felt::target;
use super::open;
use crate::failure::{Failure, Result};
use crate::located;
use crate::recordings::RecordingArgs;

/// Options for the table of the spectra that participants felt, and of the spectra of the real
/// textures.
#[derive(Args)]
#[command(next_help_heading = "Spectra")]
pub(super) struct SpectraArgs {
    /// Write the table of spectra to this CSV file. `htex study analyse` reads it with its own
    /// option `--spectra`. For each participant, texture and model, the table contains the spectrum
    /// that the participant felt, averaged over the trials. The table also contains the spectrum of
    /// each real texture
    #[arg(long, value_name = "CSV", value_parser = located::OUTPUT)]
    spectra: Option<PathBuf>,

    /// The study. Its assets contain the spectra of the real textures
    #[arg(long, value_name = "FILE", requires = "spectra")]
    study: Option<PathBuf>,

    /// What to do with recordings of trials in which speed or force left the study's target by more
    /// than 10 %. The limit is the same as for recordings of textures, but participants are not
    /// asked to keep within it
    #[arg(long, value_enum, value_name = "WHAT", requires = "spectra", default_value = "keep")]
    off_target: OffTarget,

    /// Frequency response of the sensor that recorded the trials, a CSV as for --frf. htex divides
    /// the spectra of the trials by this response
    #[arg(long, value_name = "CSV", requires = "spectra", value_parser = located::RECORDING)]
    felt_frf: Option<PathBuf>,

    /// Use the spectrum of this recording of a real texture instead of the spectrum in the
    /// texture's asset; may be given several times. The options for reading recordings apply to
    /// these recordings
    #[arg(long, value_name = "TEXTURE=FILE", requires = "spectra")]
    recorded: Vec<String>,

    #[command(flatten)]
    reading: RecordingArgs,
}

impl SpectraArgs {
    /// Returns the table and its file, if one is asked for.
    pub(super) fn table(&self, folder: &Path) -> Result<Option<(&Path, FeltSpectra)>> {
        if self.recorded.is_empty() && self.reading.is_given() {
            return Err(Failure::usage(
                "the options for reading recordings need a recording; add --recorded",
            ));
        }
        let Some(file) = &self.spectra else {
            return Ok(None);
        };
        let options = self.reading.spectrum_options()?;
        let felt =
            ReadingSettings { response: self.felt_frf.clone(), ..ReadingSettings::default() };
        let felt = felt.spectrum_options()?;
        let mut recorded = self.asset_spectra()?;
        for text in &self.recorded {
            let (texture, file) = text.split_once('=').ok_or_else(|| {
                Failure::Usage(format!("--recorded {text}: it looks like TEXTURE=FILE"))
            })?;
            let file = Path::new(file);
            let take = self.reading.read_among(file)?;
            let reference =
                Reference::from_recording(&take, file, &options, self.reading.strict())?;
            recorded.insert(texture.to_owned(), reference);
        }
        let spectra = felt_spectra(folder, &recorded, &felt, self.off_target)?;
        Ok(Some((file, spectra)))
    }

    /// Returns the spectra in the study's assets, for textures whose recording was not given.
    fn asset_spectra(&self) -> Result<BTreeMap<String, Reference>> {
        let Some(path) = &self.study else {
            return Ok(BTreeMap::new());
        };
        let study = open(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let is_given = |name: &str| {
            let named = |text: &String| text.split_once('=').is_some_and(|(own, _)| own == name);
            self.recorded.iter().any(named)
        };
        let mut recorded = BTreeMap::new();
        for texture in &study.textures {
            let name = texture.name();
            if !is_given(&name) {
                let reference =
                    Reference::from_asset(&folder.join(&texture.asset), target(&study))?;
                recorded.insert(name, reference);
            }
        }
        Ok(recorded)
    }
}
