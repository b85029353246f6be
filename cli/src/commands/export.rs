use std::path::PathBuf;

use clap::{Args, ValueEnum};
use htex_exchange::{
    Coding, ExchangeError, Exported, Format, Path, Profile, Stroke, exported, profile_names,
};
use htex_format::Measure;
use serde::Serialize;

use crate::commands::spectrum::ChoiceArgs;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::of_file::ResultOfFile;
use crate::output::{note, print, print_json, write_file};
use crate::outputs::check_outputs;
use crate::plugins::PlayerArgs;
use crate::shown::shown;

/// Write a texture at a condition, or along a stroke, as a file that phones, controllers and engines play.
///
/// The profile of an actuator decides what of the spectrum it can do. The file is read again, played through the profile, and
/// compared with the asset's own samples: that difference is printed.
#[derive(Args)]
pub(crate) struct Export {
    /// The asset
    #[arg(value_parser = located::ASSET)]
    asset: PathBuf,

    /// The format to write; `htex formats` describes them
    #[arg(long, value_name = "FORMAT", value_parser = exported())]
    to: String,

    #[command(flatten)]
    choice: ChoiceArgs,

    /// A stroke instead of a condition: a CSV of time, speed and force (t_s, speed_mm_s, force_n), or of time, position
    /// and force
    #[arg(long, value_name = "CSV", value_parser = located::RECORDING, conflicts_with_all = ["speed", "force", "seconds"])]
    stroke: Option<PathBuf>,

    /// The actuator [default: the format's own]
    #[arg(long, value_name = "NAME", value_parser = profile_names())]
    profile: Option<String>,

    /// Length of a condition, s
    #[arg(long, default_value_t = 2.0, value_name = "S")]
    seconds: f64,

    /// Sampling rate of WAV, Hz
    #[arg(long, default_value_t = 8_000, value_name = "HZ",
          value_parser = clap::value_parser!(u32).range(100..=192_000))]
    rate: u32,

    /// How hjif codes a texture
    #[arg(long, value_enum, default_value_t, value_name = "CODING")]
    coding: CodingArg,

    /// The same seed gives the same samples
    #[arg(long, default_value_t = 0)]
    seed: u64,

    #[command(flatten)]
    player: PlayerArgs,

    /// The file to write; with --to android, Kotlin if it ends in .kt, else JSON
    #[arg(short, long, value_name = "FILE", value_parser = located::OUTPUT)]
    output: PathBuf,

    /// Print JSON instead of sentences
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Default, ValueEnum)]
enum CodingArg {
    /// Seven tones
    #[default]
    Vectorial,
    /// Samples
    Wavelet,
}

#[derive(Serialize)]
struct Written<'a> {
    file: String,
    bytes: usize,
    #[serde(flatten)]
    exported: &'a Exported,
}

impl Export {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let inputs = [&self.asset].into_iter().chain(&self.stroke);
        check_outputs([self.output.as_path()], inputs.map(PathBuf::as_path))?;
        let unknown = || Failure::Usage(format!("--to {}: there is no such format", self.to));
        let mut export = htex_exchange::Export::new(Format::named(&self.to).ok_or_else(unknown)?);
        let asset = self.player.open(&self.asset)?;
        export.path = match &self.stroke {
            Some(stroke) => Path::Stroke(Stroke::open(stroke)?),
            None => {
                let beyond = self.choice.beyond(&asset, htex::Effects::default());
                note(&Vec::from_iter(beyond.of(&self.asset)?));
                Path::Condition(self.choice.motion(&asset))
            }
        };
        export.model = self.choice.model.as_deref();
        export.profile = self.profile.as_deref().map(Profile::find).transpose()?;
        export.seconds = self.seconds;
        export.rate_hz = f64::from(self.rate);
        export.seed = self.seed;
        export.kotlin = self.output.extension().is_some_and(|e| e == "kt");
        export.coding = match self.coding {
            CodingArg::Vectorial => Coding::Vectorial,
            CodingArg::Wavelet => Coding::Wavelet,
        };
        let exported =
            htex_exchange::export(&asset, &export).map_err(|error| self.failure(error))?;
        write_file(&self.output, &exported.bytes)?;
        match self.json {
            true => print_json(&Written {
                file: self.output.display().to_string(),
                bytes: exported.bytes.len(),
                exported: &exported,
            })?,
            false => {
                print(&self.text(&exported))?;
                note(&exported.notes);
            }
        }
        Ok(Exit::SUCCESS)
    }

    /// An error of playing names the asset.
    fn failure(&self, error: ExchangeError) -> Failure {
        match error {
            ExchangeError::Play(error) => Err::<(), _>(error)
                .of(&self.asset)
                .err()
                .unwrap_or(Failure::Other(String::new())),
            error => error.into(),
        }
    }

    fn text(&self, exported: &Exported) -> String {
        let lost = &exported.lost.difference;
        let felt = &lost.felt.error;
        let nine_bands = lost.quality.get(Measure::NineBand);
        format!(
            "{}: {} bytes, {} s for {}\nlost: felt {:.1} dB RMS, {:.1} dB at most, {:+.1} dB together ({} the difference threshold), \
             nine bands {:.1} dB, level {:+.1} dB; the actuator is too weak in {:.0} % of the time\nthe format loses {}\n",
            shown(&self.output),
            exported.bytes.len(),
            exported.seconds,
            exported.profile,
            felt.error_rms_db,
            felt.largest_error_db,
            felt.total_error_db,
            if felt.below_difference_threshold {
                "below"
            } else {
                "above"
            },
            nine_bands.unwrap_or_default(),
            exported.lost.level_db,
            100.0 * exported.limited,
            exported.loses,
        )
    }
}

impl From<ExchangeError> for Failure {
    fn from(error: ExchangeError) -> Self {
        use ExchangeError::{Missing, NoSamples, OutOfRange, UnknownFormat, UnknownProfile};
        match error {
            Missing { format, missing } => {
                let flags: Vec<String> = missing
                    .iter()
                    .map(|missing| format!("--{}", missing.setting.replace('_', "-")))
                    .collect();
                let words: Vec<&str> = missing.iter().map(|missing| missing.words).collect();
                Self::Usage(format!(
                    "{format} does not say {}; give {}",
                    words.join(", "),
                    flags.join(", ")
                ))
            }
            OutOfRange { name, value, range } => {
                Self::Usage(format!("--{} {value}: {range}", name.replace('_', "-")))
            }
            ExchangeError::Author(error) => error.into(),
            error @ (UnknownFormat { .. } | UnknownProfile { .. } | NoSamples { .. }) => {
                Self::Usage(error.to_string())
            }
            error => Self::Other(error.to_string()),
        }
    }
}
