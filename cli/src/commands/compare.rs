use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};

use clap::Args;
use htex_author::recording::format_names;
use htex_author::{
    AuthorError, ComparedModel, Difference, Exploration, FluctuationDifference, SECOND_TAKES_DB,
    TextureDifference, TextureSpectrum, compare, fluctuation, segment_take,
};
use htex_base::finding::{Notice, plain};
use htex_dsp::fluctuation::Fluctuation;
use htex_format::Measure;
use serde::Serialize;

use super::validate::{Kind, kind};
use crate::assets::{repeats, short_name};
use crate::columns::{Column, Errors, cells, columns, headings};
use crate::differences;
use crate::failure::{Failure, Result};
use crate::located;
use crate::output::{note, show, shown, warn};
use crate::plugins::PlayerArgs;
use crate::recordings::RecordingArgs;

/// Compare assets and recordings
///
/// Measures the difference between a recording and each model of an asset, or between two
/// recordings. For two assets, the command prints which metadata, conditions and models differ. It
/// also compares the models that both assets have, at each condition (a pair of a speed and a
/// force) of the first asset.
///
/// htex evaluates the models at the recording's speed and force if both are known. Otherwise htex
/// evaluates the models at the asset's first condition. If the first condition is silent, htex uses
/// the condition at which the texture is strongest. The error `felt` counts only what a fingertip
/// can feel. It compares, in third octaves, how far each spectrum is above the fingertip's
/// detection threshold.
///
/// Two signals with equal spectra can still fluctuate differently. If each recording lasts at least
/// 3 s, the command also compares the fluctuations (`fluct`): how strongly the power in third
/// octaves varies at rates of 1 to 64 Hz.
#[derive(Args)]
pub(crate) struct Compare {
    #[arg(help = format!("The recording ({}), or an asset to compare with another one", format_names()))]
    #[arg(value_parser = located::RECORDING, value_name = "RECORDING|ASSET")]
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
    representations: Vec<ComparedModel>,
    repeatability_rms_db: Option<f64>,
    warnings: Vec<Notice>,
}

/// Two assets, and how they differ.
#[derive(Serialize)]
struct ComparedAssets {
    asset: String,
    other: String,
    #[serde(flatten)]
    difference: TextureDifference,
}

impl Display for ComparedAssets {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let lines = differences::lines(&self.difference);
        if lines.is_empty() {
            return writeln!(f, "nothing differs");
        }
        lines.iter().try_for_each(|line| writeln!(f, "{line}"))
    }
}

/// The second recording, and how far it is from the first one.
#[derive(Serialize)]
struct OtherRecording {
    recording: String,
    speed_mm_s: Option<f64>,
    force_n: Option<f64>,
    #[serde(flatten)]
    difference: Difference,
    /// How the second recording fluctuates, compared with the first one.
    fluctuation: Option<FluctuationDifference>,
    repeatability_rms_db: Option<f64>,
}

/// The properties of a recording that are compared.
struct Recorded {
    spectrum: TextureSpectrum,
    /// `None` if this cannot be measured, e.g. in a short recording.
    fluctuation: Option<Fluctuation>,
    motion: Exploration,
    warnings: Vec<Notice>,
}

impl Compare {
    pub(crate) fn run(self) -> Result {
        // Checked before any file is parsed, so that swapped arguments lead to advice and not to a
        // parser's error.
        self.check_kinds()?;
        if kind(&self.recording) == Kind::Asset {
            return self.assets();
        }
        let recorded = self.recorded(&self.recording)?;
        let mut comparison = Comparison {
            recording: self.recording.display().to_string(),
            asset: None,
            other: None,
            speed_mm_s: recorded.motion.speed_mm_s,
            force_n: recorded.motion.force_n,
            representations: Vec::new(),
            repeatability_rms_db: recorded.spectrum.repeatability_rms_db(),
            warnings: recorded.warnings.clone(),
        };
        match kind(&self.other) {
            Kind::Recording => {
                let (other, warnings) = self.other_recording(&recorded)?;
                comparison.warnings.extend(warnings);
                comparison.other = Some(other);
            }
            _ => {
                comparison.asset = Some(self.other.display().to_string());
                comparison.representations = self.representations(&recorded)?;
            }
        }
        if !self.json {
            warn(&comparison.warnings);
        }
        show(&comparison, self.json)
    }

    /// Refuses two files that cannot be compared, and says what to do instead.
    fn check_kinds(&self) -> Result<()> {
        let advice = match (kind(&self.recording), kind(&self.other)) {
            (Kind::Asset, Kind::Asset) => return Ok(()),
            (Kind::Asset, _) => "it is an asset; give the recording first, then the asset",
            (Kind::Library, Kind::Library) => {
                "both are libraries; compare them with `htex lib diff`"
            }
            (Kind::Library, _) | (_, Kind::Library) => {
                "a library holds many textures; name one, as in LIBRARY#NAME"
            }
            _ => return Ok(()),
        };
        Err(Failure::Usage(format!("{}: {advice}", shown(&self.recording))))
    }

    /// Compares two assets.
    fn assets(&self) -> Result {
        let open = |path: &Path| self.player.open(path);
        let (first, second) = (open(&self.recording)?, open(&self.other)?);
        let difference = TextureDifference::new(&first, &second)?;
        let (asset, other) = (&self.recording, &self.other);
        let [asset, other] = [asset, other].map(|path| path.display().to_string());
        show(&ComparedAssets { asset, other, difference }, self.json)
    }

    fn representations(&self, recorded: &Recorded) -> Result<Vec<ComparedModel>> {
        let asset = self.player.open(&self.other)?;
        let Recorded { spectrum, fluctuation, motion, .. } = recorded;
        compare(&asset, spectrum, *motion, fluctuation.as_ref()).map_err(|error| match error {
            AuthorError::OtherQuantity { held, .. } => {
                Failure::Usage(format!("{error}; give --quantity {held}"))
            }
            AuthorError::Play(error) => Failure::from(error).in_file(&self.other),
            error => error.into(),
        })
    }

    /// Reads the other recording in the same way as the first one, and compares the two.
    fn other_recording(&self, first: &Recorded) -> Result<(OtherRecording, Vec<Notice>)> {
        let spectrum = &first.spectrum;
        let second = self.recorded(&self.other)?;
        let (other, found) = (second.spectrum, second.motion);
        let both = first.fluctuation.as_ref().zip(second.fluctuation.as_ref());
        let difference = Difference::between(spectrum, &other).ok_or_else(|| {
            Failure::Other(format!(
                "{}: {} at {} to {} Hz, and {} is {} at {} to {} Hz; compare recordings of one quantity and rate",
                shown(&self.other),
                other.quantity,
                other.band.low_hz,
                other.band.high_hz,
                shown(&self.recording),
                spectrum.quantity,
                spectrum.band.low_hz,
                spectrum.band.high_hz,
            ))
        })?;
        let compared = OtherRecording {
            recording: self.other.display().to_string(),
            speed_mm_s: found.speed_mm_s,
            force_n: found.force_n,
            difference,
            fluctuation: both.map(|(a, b)| FluctuationDifference::new(a, b)),
            repeatability_rms_db: other.repeatability_rms_db(),
        };
        Ok((compared, second.warnings))
    }

    fn recorded(&self, recording: &Path) -> Result<Recorded> {
        let take = self.reading.read_among(recording)?;
        let options = self.reading.spectrum_options()?;
        let reading = segment_take(&take, &options, self.reading.strict())?;
        note(&reading.notes);
        Ok(Recorded {
            spectrum: TextureSpectrum::average(&[reading.spectra], options.averaging)?,
            fluctuation: fluctuation(&take.recording),
            motion: reading.motion,
            warnings: reading.warnings,
        })
    }
}

impl Display for Comparison {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match &self.other {
            Some(other) => write!(f, "{other}")?,
            None => self.table(f)?,
        }
        match self.repeatability_rms_db {
            Some(db) => writeln!(f, "expected: {}", repeats(db)),
            None => Ok(()),
        }
    }
}

impl Comparison {
    fn table(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let columns = columns(Measure::ALL);
        writeln!(f, "  model   {}  fluct/dB", headings(&columns))?;
        for r in &self.representations {
            let value = |column: Column| {
                let Difference { quality, felt, .. } = &r.difference;
                let (quality, felt) = (Some(quality), Some(&felt.error));
                column.value(Errors { held_out: r.held_out, quality, felt })
            };
            let fluctuation = r.fluctuation.map(|f| format!("{:.2}", f.fluctuation_error_db));
            let fluctuation = fluctuation.unwrap_or_else(|| "-".to_owned());
            let (name, cells) = (short_name(&r.model), cells(&columns, value));
            writeln!(f, "  {name:8}{cells}  {fluctuation:>8}")?;
        }
        match self.representations.first().map(|first| first.fluctuation) {
            Some(Some(first)) => {
                let kurtosis = first.kurtosis[0];
                writeln!(f, "kurtosis of the recording: {kurtosis:.2} (noise: 3)")
            }
            Some(None) => writeln!(f, "{NOT_MEASURED}"),
            None => Ok(()),
        }
    }
}

impl OtherRecording {
    /// Formats a measure, e.g. `nine bands 1.20 dB`.
    fn measured(&self, measure: Measure) -> String {
        let (row, value) = (measure.row(), self.difference.quality.get(measure));
        let value = value.map_or("-".to_owned(), |x| format!("{x:.*}", row.decimals));
        format!("{} {value} {}", row.short, row.unit).trim_end().to_owned()
    }
}

impl Display for OtherRecording {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let measures: Vec<String> = Measure::stored().map(|m| self.measured(m)).collect();
        let name = plain(&self.recording);
        writeln!(f, "{name}: {}", measures.join(", "))?;
        let felt = &self.difference.felt.error;
        writeln!(
            f,
            "felt: {:.2} dB RMS, {:.2} dB at most, {:.2} dB together, {:.2} in sensation: {}",
            felt.error_rms_db,
            felt.largest_error_db,
            felt.total_error_db,
            felt.sensation_error_rms,
            felt.verdict()
        )?;
        match self.fluctuation {
            Some(fluctuation) => {
                let [third_octaves, modulation] = SECOND_TAKES_DB;
                let [first, second] = fluctuation.kurtosis;
                writeln!(
                    f,
                    "fluctuation: {:.2} dB in the modulation spectrum, kurtosis {first:.2} and {second:.2}; \
                     of second takes of one surface, 95 % differ by at most {modulation} dB, and by \
                     {third_octaves} dB in third octaves",
                    fluctuation.fluctuation_error_db
                )?;
            }
            None => writeln!(f, "{NOT_MEASURED}")?,
        }
        match self.repeatability_rms_db {
            Some(db) => writeln!(f, "expected from {name}: {}", repeats(db)),
            None => Ok(()),
        }
    }
}

/// Why a fluctuation is missing.
const NOT_MEASURED: &str =
    "fluctuation: not measured; it needs 3 s with power in every third octave";
