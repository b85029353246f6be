use std::path::{Path, PathBuf};

use clap::Args;
use htex_author::recording::format_names;
use htex_author::report::{TextureReport, texture_report};
use htex_author::settings::{FitSettings, Metadata};
use htex_author::{AssetRequest, AuthorError, FittedAsset, embed_plugins, fit_asset};
use htex_base::files::FileError;
use htex_host::Registry;

use crate::assets::{AssetSummary, check_metadata, write_asset};
use crate::failure::{Exit, Failure, Result, for_file};
use crate::grid::grid_plot;
use crate::invocation::{command_line, tool};
use crate::keys::KeyRing;
use crate::located;
use crate::output::{note, show, warn, write_file};
use crate::outputs::check_outputs;
use crate::plugins::PluginArgs;
use crate::recordings::RecordingArgs;
use crate::report::{ReportSource, measures, shares};

/// Fit models to recordings of one texture
///
/// Writes an asset (.htex) that contains the models and the measured error of each model.
///
/// A condition of a texture is a pair of a speed and a force. If several recordings have the same
/// speed and the same force within 5 %, htex averages these recordings and stores the average as
/// one condition. Every other recording becomes a condition of its own.
#[derive(Args)]
pub(crate) struct Fit {
    #[arg(help = format!("Recordings of one texture: {}", format_names()))]
    #[arg(required = true, value_parser = located::RECORDING)]
    recordings: Vec<PathBuf>,

    #[command(flatten)]
    fit: FitSettings,

    /// Set a fit option of a model, e.g. ar.order=6 or mfcc.inverse=nnls; may be given several
    /// times. `htex plugin info MODEL` lists the options
    #[arg(long, value_name = "MODEL.NAME=VALUE", display_order = 1)]
    option: Vec<String>,

    /// The asset to write
    #[arg(short, long, value_name = "HTEX", value_parser = located::OUTPUT, display_order = 3)]
    output: PathBuf,

    /// Also fit the model in this WASM module, and embed the module in the asset, so that any
    /// player can play the model; may be given several times
    #[arg(long, value_name = "WASM", display_order = 5)]
    embed_plugin: Vec<PathBuf>,

    /// Sign the embedded modules with this key of yours (`htex key list`), or with the ed25519
    /// secret key in this file (32 bytes)
    #[arg(long, value_name = "NAME|FILE", requires = "embed_plugin", display_order = 6)]
    sign_with: Option<String>,

    /// Draw the grid that --grid fits, as an SVG picture with the axes speed and force. The picture
    /// shows the parts of the recordings with steady motion, the fitted conditions with their
    /// repeatability, and the mesh between the conditions
    #[arg(long, value_name = "SVG", requires = "grid", display_order = 8)]
    grid_svg: Option<PathBuf>,

    /// Write an HTML page with the spectra and errors of all models, like the report of `htex demo`
    #[arg(long, value_name = "HTML", value_parser = located::OUTPUT, display_order = 9)]
    report: Option<PathBuf>,

    #[command(flatten)]
    metadata: Metadata,

    #[command(flatten)]
    plugins: PluginArgs,

    #[command(flatten)]
    reading: RecordingArgs,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Fit {
    pub(crate) fn run(self) -> Result {
        let key = self.sign_with.as_ref().map(PathBuf::from);
        let files = self.recordings.iter().chain(&self.embed_plugin).chain(&key);
        let files = files.chain(self.plugins.files()).map(PathBuf::as_path);
        let outputs = [&self.output].into_iter().chain(&self.report).chain(&self.grid_svg);
        check_outputs(outputs.map(PathBuf::as_path), files.chain(self.reading.inputs()))?;
        let registry = self.plugins.registry_with(&self.embed_plugin)?;
        check_metadata(&self.metadata)?;
        // Wrong options are reported first, because reading the recordings may take long.
        let request = self.request(&registry)?;
        let takes = self.reading.read(&self.recordings)?;
        let mut fitted = fit_asset(&takes, &request)?;
        self.metadata.apply(&mut fitted.asset.manifest);
        self.embed(&mut fitted.asset, &registry)?;
        let mut summary = write_asset(&self.output, &fitted.asset)?.with_felt(&fitted.felt);
        for (r, ms) in summary.representations.iter_mut().zip(&fitted.fit_ms) {
            r.fit_ms = Some(*ms);
        }
        if let (Some(file), Some(grid)) = (&self.grid_svg, &fitted.grid) {
            let picture = grid_plot(&fitted.asset.manifest.name, grid).to_svg();
            write_file(file, picture.as_bytes())?;
        }
        if let Some(file) = &self.report {
            self.write_report(file, &fitted, &summary, registry)?;
        }
        if self.json {
            summary.notes.extend(fitted.notes.iter().map(ToString::to_string));
        } else {
            warn(&fitted.warnings);
            note(&fitted.notes);
            summary.is_warned = true;
        }
        summary.grid = fitted.grid;
        show(&summary, self.json)?;
        all_named_were_fitted(&self.fit, &fitted.skipped)
    }

    fn write_report(
        &self,
        file: &Path,
        fitted: &FittedAsset,
        summary: &AssetSummary,
        registry: Registry,
    ) -> Result<()> {
        let asset = htex::Texture::with_registry(fitted.asset.clone(), registry);
        let sizes = self.recordings.iter().map(std::fs::metadata);
        let reported = ReportSource {
            fitted,
            asset: &asset,
            summary,
            recording_bytes: sizes.map(|size| size.map_or(0, |m| m.len())).sum(),
        };
        let textures = reported.textures();
        let (grid, name) = (fitted.grid.as_ref(), fitted.asset.manifest.name.clone());
        let page = TextureReport {
            title: format!("{}: recording and models", fitted.asset.manifest.name),
            measures: measures(),
            textures: textures.map_err(for_file(&self.output))?,
            command: command_line(),
            pictures: grid.map(|grid| grid_plot(&name, grid).to_svg()).into_iter().collect(),
            shares: shares([summary]),
            ..TextureReport::default()
        };
        write_file(file, texture_report(&page).as_bytes())
    }

    /// Embeds the modules of fitted models in the asset.
    fn embed(&self, asset: &mut htex_format::Asset, registry: &Registry) -> Result<()> {
        let secret_key = self.sign_with.as_deref();
        let secret_key = secret_key.map(|name| KeyRing::new()?.secret(Some(name))).transpose()?;
        // Only models that were fitted can be embedded, so this follows the fit.
        let embedded = embed_plugins(asset, registry, &self.embed_plugin, secret_key.as_ref());
        embedded.map_err(|error| match error {
            AuthorError::Module { file, error } => FileError::reading(file, error).into(),
            AuthorError::ModuleNotFitted { file, model } => {
                let file = file.display();
                Failure::Usage(format!(
                    "--embed-plugin {file}: {model} was not fitted; add it to --model"
                ))
            }
            other => Failure::Usage(format!("--embed-plugin {other}")),
        })
    }

    fn request(&self, registry: &Registry) -> Result<AssetRequest> {
        let mut settings = self.fit.clone();
        settings.strict = Some(self.reading.strict());
        settings.add_options(&self.option)?;
        let stem = self.output.file_stem();
        let name = stem.map(|s| s.to_string_lossy()).unwrap_or_default();
        let request = settings.request(registry, &self.reading.settings, &name, &tool())?;
        Ok(request.with_law_of(&self.metadata))
    }
}

/// Returns an error if a model that the user named could not be fitted. The written asset has the
/// other models.
pub(crate) fn all_named_were_fitted(fit: &FitSettings, skipped: &[(String, String)]) -> Result {
    let named = fit.named_of(skipped);
    if named.is_empty() {
        Ok(Exit::SUCCESS)
    } else {
        Err(Failure::Other(format!(
            "a model named by `--model` could not be fitted, and the asset holds only the others: {}",
            named.join("; ")
        )))
    }
}
