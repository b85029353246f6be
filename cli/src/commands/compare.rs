use std::path::PathBuf;

use clap::Args;
use htex_author::{Exploration, TextureSpectrum, measure, read_take};
use serde::Serialize;

use crate::assets::short_name;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::output::{note, print, print_json, warn};
use crate::plugins::PlayerArgs;
use crate::recordings::RecordingArgs;

/// Measure each representation of an asset against a recording.
///
/// The asset plays at the recording's speed and force where both are known, else at its first
/// condition.
#[derive(Args)]
pub(crate) struct Compare {
    /// The recording: CSV, WAV, FLAC, NPY, MATLAB, TDMS, Parquet, Arrow, HDF5
    #[arg(value_parser = located::RECORDING)]
    recording: PathBuf,

    /// The asset
    #[arg(value_parser = located::ASSET)]
    asset: PathBuf,

    #[command(flatten)]
    reading: RecordingArgs,

    #[command(flatten)]
    player: PlayerArgs,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Comparison {
    recording: String,
    asset: String,
    speed_mm_s: Option<f64>,
    force_n: Option<f64>,
    representations: Vec<Compared>,
    repeatability_rms_db: Option<f64>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Compared {
    model: String,
    level_rms: f64,
    #[serde(flatten)]
    quality: htex_format::Quality,
}

impl Compare {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let (spectrum, found, warnings) = self.spectrum()?;
        let asset = self.player.open(&self.asset)?;
        let (held, recorded) = (asset.quantity(), spectrum.quantity);
        if held != recorded {
            return Err(Failure::Usage(format!(
                "the asset holds {held}, the recording is read as {recorded}; give --quantity {held}"
            )));
        }
        let representations = self.compare(&asset, &spectrum, found)?;
        let comparison = Comparison {
            recording: self.recording.display().to_string(),
            asset: self.asset.display().to_string(),
            speed_mm_s: found.speed_mm_s,
            force_n: found.force_n,
            representations,
            repeatability_rms_db: spectrum.repeatability_rms_db,
            warnings,
        };
        if self.json {
            print_json(&comparison)?;
        } else {
            warn(&comparison.warnings);
            print(&comparison.to_text())?;
        }
        Ok(Exit::SUCCESS)
    }

    fn spectrum(&self) -> Result<(TextureSpectrum, Exploration, Vec<String>), Failure> {
        let take = self.reading.read_one(&self.recording)?;
        let options = self.reading.spectrum_options()?;
        let reading = read_take(&take, &options, self.reading.strict())?;
        note(&reading.notes);
        Ok((
            TextureSpectrum::average(&[reading.part], options.averaging)?,
            reading.condition,
            reading.warnings,
        ))
    }

    fn compare(
        &self,
        asset: &htex::Asset,
        spectrum: &TextureSpectrum,
        found: Exploration,
    ) -> Result<Vec<Compared>, Failure> {
        let motion = found.speed_mm_s.zip(found.force_n);
        let motion = motion.map(|(speed, force)| htex::Motion::new(speed, force));
        let mut compared = Vec::new();
        for representation in &asset.manifest().representations {
            let (parameters, level_rms) = asset
                .parameters(Some(&representation.model), motion)
                .map_err(|error| Failure::asset(&self.asset, error))?;
            let model = asset
                .loaded_model(Some(&representation.model))
                .map_err(|error| Failure::asset(&self.asset, error))?;
            compared.push(Compared {
                model: representation.model.clone(),
                level_rms,
                quality: measure(&model, &parameters, level_rms, spectrum.as_ref())?,
            });
        }
        Ok(compared)
    }
}

impl Comparison {
    fn to_text(&self) -> String {
        let mut text = String::from(
            "  model      corr.  bands/dB  gain-matched/dB  third-oct/dB  log-sp/dB  played/dB\n",
        );
        for r in &self.representations {
            let q = &r.quality;
            text += &format!(
                "  {:8}  {:>6.3}  {:>8.2}  {:>15.2}  {:>12.2}  {:>9.2}  {:>9.2}\n",
                short_name(&r.model),
                q.spectral_correlation,
                q.band_error_rms_db,
                q.band_error_matched_rms_db.unwrap_or(f64::NAN),
                q.third_octave_error_rms_db.unwrap_or(f64::NAN),
                q.log_spectral_distance_db.unwrap_or(f64::NAN),
                q.samples_band_error_rms_db.unwrap_or(f64::NAN)
            );
        }
        if let Some(db) = self.repeatability_rms_db {
            text += &format!("the recording itself repeats within {db:.2} dB\n");
        }
        text
    }
}
