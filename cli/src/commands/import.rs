use std::path::PathBuf;

use clap::Args;
use htex_author::settings::{FitSettings, Metadata};
use htex_exchange::{
    Fitting, ImportError, MOST_BYTES, Physical, Profile, imported, imported_asset, profile_names,
    recording_of,
};
use htex_files::{AtFile, read_regular};
use htex_format::Quantity;

use crate::assets::AssetSummary;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::metadata::checked;
use crate::models::tool;
use crate::output::{note, print, print_json, warn, write_file};
use crate::outputs::check_outputs;
use crate::plugins::PluginArgs;
use crate::shown::shown;

/// Read a file of another haptic format as a texture: a signal that is fitted as a recording is.
///
/// These formats know no newtons, no speed and no force: say how strong 1 is (--full-scale), and at which speed and force the
/// file is felt. `htex formats` lists what is kept and lost.
#[derive(Args)]
pub(crate) struct Import {
    #[arg(help = format!("The file: {}", imported()))]
    #[arg(value_parser = located::RECORDING)]
    file: PathBuf,

    /// The unit at full scale, which the file calls 1: newtons, or m/s² with --quantity acceleration
    #[arg(long, value_name = "UNIT", display_order = 1)]
    full_scale: Option<f64>,

    /// What the full scale is of
    #[arg(long, value_enum, default_value_t, display_order = 1)]
    quantity: Quantity,

    /// Speed of the finger, mm/s
    #[arg(long, value_name = "MM_S", display_order = 1)]
    speed: Option<f64>,

    /// Its normal force, N
    #[arg(long, value_name = "N", display_order = 1)]
    force: Option<f64>,

    /// The actuator whose range the file's frequencies are positions in [default: the format's own]
    #[arg(long, value_name = "NAME", value_parser = profile_names(), display_order = 1)]
    profile: Option<String>,

    #[command(flatten)]
    fit: FitSettings,

    /// The asset to write
    #[arg(short, long, value_name = "HTEX", value_parser = located::OUTPUT, display_order = 3)]
    output: PathBuf,

    #[command(flatten)]
    metadata: Metadata,

    #[command(flatten)]
    plugins: PluginArgs,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Import {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        check_outputs(
            [self.output.as_path()],
            [self.file.as_path()]
                .into_iter()
                .chain(self.plugins.files().iter().map(PathBuf::as_path)),
        )?;
        checked(&self.metadata)?;
        let profile = self.profile.as_deref().map(Profile::find).transpose()?;
        let physical = Physical {
            full_scale: self.full_scale,
            quantity: self.quantity,
            speed_mm_s: self.speed,
            force_n: self.force,
        };
        let bytes = read_regular(&self.file, MOST_BYTES).reading(&self.file)?;
        let name = self.file.file_name().map(|name| name.to_string_lossy());
        let recording = recording_of(&name.unwrap_or_default(), &bytes, &physical, profile)?;
        let stem = self.output.file_stem().map(|stem| stem.to_string_lossy());
        let fitting = Fitting {
            settings: self.fit,
            metadata: self.metadata,
            tool: tool(),
        };
        let registry = self.plugins.registry()?;
        let name = stem.unwrap_or_default();
        let fitted = imported_asset(recording, &physical, &name, &fitting, &registry)?;
        let bytes = fitted.asset.to_bytes()?;
        write_file(&self.output, &bytes)?;
        let mut summary = AssetSummary::new(&self.output, bytes.len() as u64, &fitted.asset)
            .with_felt(&fitted.felt);
        if self.json {
            print_json(&summary)?;
        } else {
            warn(&fitted.warnings);
            note(&fitted.notes);
            summary.warnings.clear();
            print(&format!(
                "imported {}\n{}",
                shown(&self.file),
                summary.to_text()
            ))?;
        }
        Ok(Exit::SUCCESS)
    }
}

impl From<ImportError> for Failure {
    fn from(error: ImportError) -> Self {
        match error {
            ImportError::Settings(error) => error.into(),
            ImportError::Author(error) => error.into(),
            error => Self::Other(error.to_string()),
        }
    }
}
