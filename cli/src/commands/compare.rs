use std::path::{Path, PathBuf};

use clap::Args;
use htex_author::recording::format_names;
use htex_author::{Exploration, FeltError, TextureSpectrum, agreement, felt, measure, read_take};
use htex_dsp::vibrotactile::Listener;
use htex_finding::{Notice, plain};
use htex_format::{Measure, Quality};
use serde::Serialize;

use super::validate::{Kind, kind};
use crate::assets::short_name;
use crate::columns::{Column, cells, columns, headings};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::output::{note, print, print_json, warn};
use crate::plugins::PlayerArgs;
use crate::recordings::RecordingArgs;
use crate::shown::shown;

/// Measure each representation of an asset, or another recording, against a recording.
///
/// The asset plays at the recording's speed and force where both are known, else at its first
/// condition. `felt` is the part of the difference that is above the detection threshold of a fingertip, in third octaves.
#[derive(Args)]
pub(crate) struct Compare {
    #[arg(help = format!("The recording: {}", format_names()))]
    #[arg(value_parser = located::RECORDING)]
    recording: PathBuf,

    /// The asset, or another recording
    #[arg(value_parser = located::RECORDING, value_name = "ASSET|RECORDING")]
    other: PathBuf,

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
    #[serde(skip_serializing_if = "Option::is_none")]
    asset: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    other: Option<OtherRecording>,
    speed_mm_s: Option<f64>,
    force_n: Option<f64>,
    representations: Vec<Compared>,
    repeatability_rms_db: Option<f64>,
    warnings: Vec<Notice>,
}

#[derive(Serialize)]
struct Compared {
    model: String,
    level_rms: f64,
    #[serde(flatten)]
    quality: Quality,
    felt: FeltDifference,
}

/// A recording that is compared with the first.
#[derive(Serialize)]
struct OtherRecording {
    recording: String,
    speed_mm_s: Option<f64>,
    force_n: Option<f64>,
    level_rms: f64,
    #[serde(flatten)]
    quality: Quality,
    felt: FeltDifference,
    repeatability_rms_db: Option<f64>,
}

/// What is felt of a difference.
#[derive(Serialize)]
struct FeltDifference {
    centre_hz: Vec<f64>,
    error_db: Vec<f64>,
    #[serde(flatten)]
    error: FeltError,
}

impl Compare {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let (spectrum, found, warnings) = self.spectrum(&self.recording)?;
        let mut comparison = Comparison {
            recording: self.recording.display().to_string(),
            asset: None,
            other: None,
            speed_mm_s: found.speed_mm_s,
            force_n: found.force_n,
            representations: Vec::new(),
            repeatability_rms_db: spectrum.repeatability_rms_db,
            warnings,
        };
        match kind(&self.other) {
            Kind::Recording => {
                let (other, warnings) = self.other_recording(&spectrum)?;
                comparison.warnings.extend(warnings);
                comparison.other = Some(other);
            }
            _ => {
                comparison.asset = Some(self.other.display().to_string());
                comparison.representations = self.representations(&spectrum, found)?;
            }
        }
        if self.json {
            print_json(&comparison)?;
        } else {
            warn(&comparison.warnings);
            print(&comparison.to_text())?;
        }
        Ok(Exit::SUCCESS)
    }

    fn representations(
        &self,
        spectrum: &TextureSpectrum,
        found: Exploration,
    ) -> Result<Vec<Compared>, Failure> {
        let asset = self.player.open(&self.other)?;
        let (held, recorded) = (asset.quantity(), spectrum.quantity);
        if held != recorded {
            return Err(Failure::Usage(format!(
                "the asset holds {held}, the recording is read as {recorded}; give --quantity {held}"
            )));
        }
        self.compare(&asset, spectrum, found)
    }

    /// Compares another recording, which is read as the first.
    fn other_recording(
        &self,
        spectrum: &TextureSpectrum,
    ) -> Result<(OtherRecording, Vec<Notice>), Failure> {
        let (other, found, warnings) = self.spectrum(&self.other)?;
        if (other.quantity, other.band) != (spectrum.quantity, spectrum.band) {
            return Err(Failure::Other(format!(
                "{}: {} at {} to {} Hz, and {} is {} at {} to {} Hz; compare recordings of one quantity and rate",
                shown(&self.other),
                other.quantity,
                other.band.low_hz,
                other.band.high_hz,
                shown(&self.recording),
                spectrum.quantity,
                spectrum.band.low_hz,
                spectrum.band.high_hz,
            )));
        }
        let quality = Quality::from(agreement(spectrum.as_ref(), &other.magnitude));
        let compared = OtherRecording {
            recording: self.other.display().to_string(),
            speed_mm_s: found.speed_mm_s,
            force_n: found.force_n,
            level_rms: htex_dsp::grid::level_rms(&other.magnitude),
            felt: FeltDifference::new(spectrum, &other.magnitude, &quality),
            quality,
            repeatability_rms_db: other.repeatability_rms_db,
        };
        Ok((compared, warnings))
    }

    fn spectrum(
        &self,
        recording: &Path,
    ) -> Result<(TextureSpectrum, Exploration, Vec<Notice>), Failure> {
        let take = self.reading.read_among(recording)?;
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
                .map_err(|error| Failure::asset(&self.other, error))?;
            let model = asset
                .loaded_model(Some(&representation.model))
                .map_err(|error| Failure::asset(&self.other, error))?;
            let shape = model.magnitude(&parameters, spectrum.band, &spectrum.frequency_hz)?;
            let magnitude: Vec<f64> = shape.iter().map(|m| m * level_rms).collect();
            let quality = measure(&model, &parameters, level_rms, spectrum.as_ref())?;
            compared.push(Compared {
                model: representation.model.clone(),
                level_rms,
                felt: FeltDifference::new(spectrum, &magnitude, &quality),
                quality,
            });
        }
        Ok(compared)
    }
}

impl FeltDifference {
    fn new(reference: &TextureSpectrum, magnitude: &[f64], quality: &Quality) -> Self {
        let felt = felt(
            reference.as_ref(),
            magnitude,
            reference.quantity,
            &Listener::default(),
        );
        Self {
            centre_hz: felt.centre_hz,
            error_db: felt.error_db,
            error: FeltError::new(reference, magnitude, quality.get(Measure::NineBand)),
        }
    }
}

impl Comparison {
    fn to_text(&self) -> String {
        let mut text = match &self.other {
            Some(other) => other.to_text(),
            None => self.table(),
        };
        if let Some(db) = self.repeatability_rms_db {
            text += &format!("the recording itself repeats within {db:.2} dB\n");
        }
        text
    }

    fn table(&self) -> String {
        let columns = columns(Measure::ALL);
        let mut text = format!("  model   {}\n", headings(&columns));
        for r in &self.representations {
            let of = |column: Column| column.of(Some(&r.quality), Some(&r.felt.error));
            text += &format!("  {:8}{}\n", short_name(&r.model), cells(&columns, of));
        }
        text
    }
}

impl OtherRecording {
    /// A measure: `nine bands 1.20 dB`.
    fn measured(&self, measure: Measure) -> String {
        let (row, value) = (measure.row(), self.quality.get(measure));
        let value = value.map_or("-".to_owned(), |x| format!("{x:.*}", row.decimals));
        format!("{} {value} {}", row.short, row.unit)
            .trim_end()
            .to_owned()
    }

    fn to_text(&self) -> String {
        let measures: Vec<String> = Measure::stored().map(|m| self.measured(m)).collect();
        let name = plain(&self.recording);
        let mut text = format!("{name}: {}\n", measures.join(", "));
        let felt = &self.felt.error;
        text += &format!(
            "felt: {:.2} dB RMS, {:.2} dB at most, {:.2} dB together: {} the difference threshold\n",
            felt.error_rms_db,
            felt.largest_error_db,
            felt.total_error_db,
            if felt.below_difference_threshold {
                "below"
            } else {
                "above"
            }
        );
        if let Some(db) = self.repeatability_rms_db {
            text += &format!("{} repeats within {db:.2} dB\n", plain(&self.recording));
        }
        text
    }
}
