use std::path::PathBuf;

use clap::Args;
use htex_author::settings::{FitSettings, Metadata};
use htex_base::files::{AtFile, read_regular};
use htex_exchange::{Format, MOST_BYTES, Physical, Profile, SignalSettings, imported};
use htex_format::{Quantity, license_file, read_license_file};

use crate::assets::{AssetSummary, check_metadata};
use crate::commands::fit::all_named_were_fitted;
use crate::explicit_args::ExplicitArgs;
use crate::failure::Result;
use crate::invocation::tool;
use crate::located;
use crate::output::{note, print, show, shown, warn, write_file};
use crate::outputs::check_outputs;
use crate::plugins::PluginArgs;

/// Read another haptic format as a texture
///
/// A model file of the Penn Haptic Texture Toolkit states its units, speeds and forces, so htex
/// converts the file without further information. If a material in a glTF file embeds a `.htex`
/// asset, htex extracts this asset unchanged.
///
/// A file of any other format is a signal or an image that does not state its units, speed and
/// force. For such a file, give the physical value of the full scale (--full-scale), and the speed
/// and the force at which the finger is to feel the texture (--speed, --force). htex fits models to
/// a signal in the same way as to a recording, and converts an image to a friction map.
///
/// Unless you give --license and --author, htex reads licence and author from the file, or from
/// FILE.license next to the file. `htex formats` lists which parts of a texture each format keeps.
#[derive(Args)]
pub(crate) struct Import {
    #[arg(help = format!("The file: {}", imported()))]
    #[arg(value_parser = located::RECORDING)]
    file: PathBuf,

    #[command(flatten)]
    given: ExplicitArgs<Settings>,

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

/// Settings. Each format uses only some of these settings.
#[derive(Args)]
struct Settings {
    #[command(flatten)]
    signal: SignalSettings,

    /// Physical quantity of the signal. The value of --full-scale is in the unit of this quantity
    #[arg(long, value_enum, default_value_t, display_order = 1)]
    quantity: Quantity,

    /// Speed of the finger at which the texture is to be felt, mm/s
    #[arg(long, value_name = "MM_S", display_order = 1)]
    speed: Option<f64>,

    /// Normal force of the finger at which the texture is to be felt, N
    #[arg(long, value_name = "N", display_order = 1)]
    force: Option<f64>,

    #[command(flatten)]
    fit: FitSettings,

    /// Set a fit option of a model, e.g. ar.order=6 or mfcc.inverse=nnls; may be given several
    /// times. `htex plugin info MODEL` lists the options
    #[arg(long, value_name = "MODEL.NAME=VALUE", display_order = 1)]
    option: Vec<String>,
}

impl Import {
    pub(crate) fn run(self) -> Result {
        let plugins = self.plugins.files().iter().map(PathBuf::as_path);
        let beside = license_file(&self.file);
        // The command also reads the licence file, so the output must not replace it.
        let inputs = [self.file.as_path(), &beside].into_iter().chain(plugins);
        check_outputs([self.output.as_path()], inputs)?;
        check_metadata(&self.metadata)?;
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        let given = self.given.settings.iter().map(String::as_str);
        Format::of_file(&name)?.check_import(given)?;
        let bytes = read_regular(&self.file, MOST_BYTES).reading(&self.file)?;
        let registry = self.plugins.registry()?;
        let stem = self.output.file_stem().unwrap_or_default().to_string_lossy();
        let tool = tool();
        let mut how = self.how(&stem, &tool)?;
        let beside = read_license_file(&self.file).reading(license_file(&self.file))?;
        how.license_file = beside.as_deref();
        let imported = htex_exchange::import(&name, &bytes, &how, &registry)?;
        self.write(imported)
    }

    fn how<'a>(&self, name: &'a str, tool: &'a str) -> Result<htex_exchange::Import<'a>> {
        let settings = &self.given.values;
        let mut fit = settings.fit.clone();
        fit.add_options(&settings.option)?;
        let profile = settings.signal.profile.as_deref();
        Ok(htex_exchange::Import {
            name,
            physical: Physical {
                full_scale: settings.signal.full_scale,
                quantity: settings.quantity,
                speed_mm_s: settings.speed,
                force_n: settings.force,
                pitch_mm: settings.signal.pitch_mm,
            },
            profile: profile.map(Profile::find).transpose()?,
            fit,
            metadata: self.metadata.clone(),
            license_file: None,
            tool,
        })
    }

    fn write(&self, imported: htex_exchange::ImportedAsset) -> Result {
        let bytes = imported.to_bytes()?;
        write_file(&self.output, &bytes)?;
        let mut summary = AssetSummary::new(&self.output, bytes.len() as u64, &imported.asset)
            .with_felt(&imported.felt);
        if self.json {
            // The asset may state some of these warnings already.
            let stated = &summary.manifest.provenance.warnings;
            let warnings = imported.warnings.iter().map(ToString::to_string);
            summary.warnings = warnings.filter(|warning| !stated.contains(warning)).collect();
            summary.notes.extend(imported.notes.iter().map(ToString::to_string));
        } else {
            warn(&imported.warnings);
            note(&imported.notes);
            summary.is_warned = true;
            print(&format!("imported {}\n", shown(&self.file)))?;
        }
        show(&summary, self.json)?;
        all_named_were_fitted(&self.given.values.fit, &imported.skipped)
    }
}
