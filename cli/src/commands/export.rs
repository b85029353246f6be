use std::fmt::{Display, Formatter};
use std::path::{MAIN_SEPARATOR, PathBuf};

use clap::Args;
use htex_base::files::{AtFile, OwnFolder, read_regular};
use htex_base::finding::plain;
use htex_exchange::{
    ActuatorPlay, Coding, ExchangeError, ExportedFile, Format, Loss, MOST_BYTES, Path, Profile,
    Stroke, Writes, exported, profile_names,
};
use htex_format::Measure;
use serde::Serialize;

use crate::commands::spectrum::ChoiceArgs;
use crate::explicit_args::ExplicitArgs;
use crate::failure::{Failure, Result, for_file};
use crate::located;
use crate::output::{OutputFile, note, show};
use crate::outputs::check_outputs;
use crate::plugins::PlayerArgs;
use crate::scene_sound::{Scene, is_scene};

/// Write a texture in another haptic format
///
/// Writes a texture or a whole scene as a file that phones, game controllers and game engines can
/// play. The file contains a texture as it feels at one speed and force, or along a stroke of the
/// finger.
///
/// The profile of an actuator describes which part of the spectrum the actuator can reproduce. The
/// command prints how much the export changes the spectrum and the level. To measure this, it reads
/// the written file again, simulates how the actuator plays the file, and compares the result with
/// the samples of the texture. The command also prints the licence and the author that the written
/// file states.
#[derive(Args)]
pub(crate) struct Export {
    /// The asset or the scene to export. Unlike an asset, a scene also contains the motion of the
    /// finger and says which models play. LIBRARY#GLOB exports several textures of a library
    #[arg(value_parser = located::ASSETS)]
    asset: PathBuf,

    /// The format to write; `htex formats` describes all formats
    #[arg(long, value_name = "FORMAT", value_parser = exported())]
    to: String,

    #[command(flatten)]
    given: ExplicitArgs<Settings>,

    #[command(flatten)]
    player: PlayerArgs,

    /// The file to write; for several textures, the folder to write to. With --to android, the
    /// command writes Kotlin if the name ends in .kt, and otherwise JSON. With --to gltf, the
    /// command writes JSON if the name ends in .gltf, and otherwise the binary form (.glb)
    #[arg(short, long, value_name = "FILE", value_parser = located::OUTPUT)]
    output: PathBuf,

    /// Print JSON instead of sentences
    #[arg(long)]
    json: bool,
}

/// Settings. Each format uses only some of these settings.
#[derive(Args)]
struct Settings {
    #[command(flatten)]
    choice: ChoiceArgs,

    /// Export the texture along this stroke of the finger, instead of at one speed and force. The
    /// CSV has the columns t_s, speed_mm_s and force_n, or a position instead of the speed
    #[arg(long, value_name = "CSV", value_parser = located::RECORDING, conflicts_with_all = ["speed", "force", "seconds"])]
    stroke: Option<PathBuf>,

    /// Profile of the actuator that will play the file; `htex formats` lists the profiles [default:
    /// depends on the format]
    #[arg(long, value_name = "NAME", value_parser = profile_names())]
    profile: Option<String>,

    /// Duration, s [default: the scene's own duration, or 2]
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,

    /// Sample rate of a WAV file, Hz [default: 8000]
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(100..=192_000))]
    rate: Option<u32>,

    /// How a .hjif file encodes the texture [default: vectorial]
    #[arg(long, value_enum, value_name = "CODING")]
    coding: Option<Coding>,

    /// Seed of the random numbers: the same seed gives the same samples
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// The file that was written.
#[derive(Serialize)]
struct ExportReport {
    file: String,
    bytes: usize,
    #[serde(flatten)]
    exported: ExportedFile,
}

/// The files that were written, one or several.
#[derive(Serialize)]
#[serde(transparent)]
struct ExportReports(Vec<ExportReport>);

impl Display for ExportReports {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        self.0.iter().try_for_each(|report| report.fmt(f))
    }
}

impl Export {
    pub(crate) fn run(mut self) -> Result {
        let format = Format::find_for_export(&self.to)?;
        format.check_export(self.given.settings.iter().map(String::as_str))?;
        let assets = located::each(std::slice::from_ref(&self.asset));
        let ends_as_folder = self.output.to_string_lossy().ends_with(['/', MAIN_SEPARATOR]);
        if let ([asset], false) = (&assets[..], ends_as_folder || self.output.is_dir()) {
            self.asset.clone_from(asset);
            let output = self.output.clone();
            return show(&self.write(format, OutputFile::Named(&output))?, self.json);
        }
        let folder = OwnFolder::new(&self.output);
        let mut reports = Vec::new();
        for asset in assets {
            let own = asset.file_name().map(PathBuf::from).unwrap_or_default();
            let name = located::texture_name(&asset).unwrap_or(own);
            let extension = format.extensions.first().copied().unwrap_or(format.name);
            let inside = name.with_extension(extension);
            self.output = folder.path().join(&inside);
            self.asset = asset;
            reports.push(self.write(format, OutputFile::Inside(&folder, &inside))?);
        }
        show(&ExportReports(reports), self.json)
    }

    /// Exports one texture or scene to a file, which is `self.output`.
    fn write(&self, format: &'static Format, to: OutputFile<'_>) -> Result<ExportReport> {
        let exported =
            if is_scene(&self.asset) { self.of_scene(format)? } else { self.of_asset(format)? };
        to.write(&exported.bytes)?;
        if !self.json {
            note(&exported.notes);
        }
        let (file, bytes) = (self.output.display().to_string(), exported.bytes.len());
        Ok(ExportReport { file, bytes, exported })
    }

    fn of_asset(&self, format: &'static Format) -> Result<ExportedFile> {
        let inputs = [&self.asset].into_iter().chain(&self.given.values.stroke);
        check_outputs([self.output.as_path()], inputs.map(PathBuf::as_path))?;
        let asset = self.player.open(&self.asset)?;
        let file = self.file(format)?;
        let mut export = self.export(format)?;
        export.path = self.path(&asset)?;
        export.file = file.as_deref();
        htex_exchange::export(&asset, &export).map_err(|error| self.failure(error))
    }

    fn of_scene(&self, format: &'static Format) -> Result<ExportedFile> {
        format.check_export_of_scene(self.given.settings.iter().map(String::as_str))?;
        let scene = Scene::open(&self.asset, &self.player, self.given.values.seconds)?;
        // Only the loaded scene knows which other files it reads.
        check_outputs([self.output.as_path()], scene.inputs.iter().map(PathBuf::as_path))?;
        let export = self.export(format)?;
        scene
            .with(|sound| htex_exchange::export_scene(sound, &export))
            .map_err(|error| self.failure(error))
    }

    fn export(&self, format: &'static Format) -> Result<htex_exchange::Export<'_>> {
        let settings = &self.given.values;
        let mut export = htex_exchange::Export::new(format);
        export.model = settings.choice.model.as_deref();
        export.profile = settings.profile.as_deref().map(Profile::find).transpose()?;
        export.seconds = settings.seconds.unwrap_or(export.seconds);
        export.rate_hz = settings.rate.map(f64::from);
        export.seed = settings.seed;
        export.extension = self.output.extension().and_then(|e| e.to_str());
        export.coding = settings.coding;
        Ok(export)
    }

    /// Reads the asset's file if the export contains it.
    fn file(&self, format: &Format) -> Result<Option<Vec<u8>>> {
        match format.writes {
            Some(Writes::Asset(_)) => {
                let bytes = read_regular(&self.asset, MOST_BYTES).reading(&self.asset)?;
                Ok(Some(bytes))
            }
            _ => Ok(None),
        }
    }

    fn path(&self, asset: &htex::Texture) -> Result<Path> {
        let settings = &self.given.values;
        if let Some(stroke) = &settings.stroke {
            return Ok(Path::Stroke(Stroke::open(stroke)?));
        }
        Ok(Path::Condition(settings.choice.motion(asset).map_err(for_file(&self.asset))?))
    }

    /// Converts an error. An error from playing also names the asset.
    fn failure(&self, error: ExchangeError) -> Failure {
        match error {
            ExchangeError::Play(error) => Failure::from(error).in_file(&self.asset),
            error => error.into(),
        }
    }
}

impl Display for ExportReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { file, bytes, exported } = self;
        let played = exported.played.as_ref();
        writeln!(
            f,
            "{}: {bytes} bytes{}{}{}\nthe format loses {}\n{}",
            plain(file),
            played.map(played_text).unwrap_or_default(),
            exported.lost.as_ref().map(lost).unwrap_or_default(),
            played.map(limited).unwrap_or_default(),
            exported.loses,
            exported.rights,
        )
    }
}

fn played_text(played: &ActuatorPlay) -> String {
    format!(", {} s for {}", played.seconds, played.profile)
}

fn limited(played: &ActuatorPlay) -> String {
    format!("; the actuator is too weak in {:.0} % of the time", 100.0 * played.limited)
}

/// Describes in words what the exported file loses.
fn lost(lost: &Loss) -> String {
    let felt = &lost.difference.felt.error;
    let nine_bands = lost.difference.quality.get(Measure::NineBand);
    format!(
        "\nlost: felt {:.1} dB RMS, {:.1} dB at most, {:+.1} dB together ({}), \
         nine bands {:.1} dB, level {:+.1} dB",
        felt.error_rms_db,
        felt.largest_error_db,
        felt.total_error_db,
        felt.verdict(),
        nine_bands.unwrap_or_default(),
        lost.level_db,
    )
}

impl From<ExchangeError> for Failure {
    fn from(error: ExchangeError) -> Self {
        use ExchangeError::{
            Missing, NoSamples, OutOfRange, Rights, UnknownFormat, UnknownName, Unused,
        };
        let flag = |setting: &str| format!("--{}", setting.replace('_', "-"));
        match error {
            ExchangeError::Author(error) => error.into(),
            error @ (Missing { .. }
            | Unused { .. }
            | OutOfRange { .. }
            | Rights { .. }
            | UnknownFormat { .. }
            | UnknownName { .. }
            | NoSamples { .. }) => Self::Usage(error.message_with(&flag)),
            error => Self::other(error),
        }
    }
}
