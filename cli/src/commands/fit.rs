use std::path::{Path, PathBuf};

use clap::Args;
use htex_author::{AssetRequest, FittedAsset, Level, fit_asset};
use htex_format::Plugin;
use htex_host::{LoadedModel, Origin, Registry};
use htex_report::{TextureReport, texture_report};

use crate::assets::AssetSummary;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::invocation;
use crate::metadata::MetadataArgs;
use crate::models::{model_requests, tool};
use crate::output::{note, print, print_json, warn, write_file};
use crate::outputs::check_outputs;
use crate::plugins::PluginArgs;
use crate::recordings::RecordingArgs;
use crate::report::Reported;

/// Fit models to recordings of one texture and write the asset.
///
/// Recordings whose speed and force differ by less than 5 % are averaged as one exploration
/// condition; others become further conditions of the same texture.
#[derive(Args)]
pub(crate) struct Fit {
    /// Recordings of one texture: CSV, WAV or NPY
    #[arg(required = true)]
    recordings: Vec<PathBuf>,

    /// Models by short name or id, comma-separated, or `all`
    #[arg(
        long,
        default_value = "all",
        value_delimiter = ',',
        value_name = "ID,…"
    )]
    model: Vec<String>,

    /// A fit option of a model, e.g. ar.order=6 or mfcc.inverse=nnls; may be given several times
    #[arg(long, value_name = "MODEL.NAME=VALUE")]
    option: Vec<String>,

    /// Level of a representation: the recording's RMS in the band, so that it plays as strong as the
    /// recording, or that of its own fit. Bands, which keeps energies, always has
    /// that of its fit
    #[arg(long, value_enum, default_value = "recording")]
    level: LevelArg,

    /// The asset to write
    #[arg(short, long, value_name = "HTEX")]
    output: PathBuf,

    /// Keep the recorded spectrum in the asset (788 bytes a condition, before compression)
    #[arg(long)]
    keep_reference: bool,

    /// A model's WASM module to fit with and to bring along in the asset, so that any player can
    /// play it; may be given several times
    #[arg(long, value_name = "WASM")]
    embed_plugin: Vec<PathBuf>,

    /// Sign embedded modules with this ed25519 secret key: a file of 32 bytes
    #[arg(long, value_name = "FILE", requires = "embed_plugin")]
    sign_with: Option<PathBuf>,

    /// Draw the spectra and errors of all models into this HTML page, as `htex demo` does
    #[arg(long, value_name = "HTML")]
    report: Option<PathBuf>,

    #[command(flatten)]
    metadata: MetadataArgs,

    #[command(flatten)]
    plugins: PluginArgs,

    #[command(flatten)]
    reading: RecordingArgs,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum LevelArg {
    Fitted,
    Recording,
}

impl Fit {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let files = self
            .recordings
            .iter()
            .chain(&self.embed_plugin)
            .chain(&self.sign_with);
        let files = files.chain(self.plugins.files()).map(PathBuf::as_path);
        let outputs = [&self.output].into_iter().chain(&self.report);
        check_outputs(
            outputs.map(PathBuf::as_path),
            files.chain(self.reading.frf()),
        )?;
        let registry = self.plugins.registry_with(&self.embed_plugin)?;
        self.metadata.check()?;
        let request = self.request(&registry)?;
        let takes = self.reading.read(&self.recordings)?;
        let mut fitted = fit_asset(&takes, &request)?;
        self.metadata.apply(&mut fitted.asset.manifest);
        self.embed(&mut fitted.asset, &registry)?;
        let bytes = fitted
            .asset
            .to_bytes()
            .map_err(htex_author::AuthorError::from)?;
        write_file(&self.output, &bytes)?;
        let mut summary = AssetSummary::new(&self.output, bytes.len() as u64, &fitted.asset);
        for (r, ms) in summary.representations.iter_mut().zip(&fitted.fit_ms) {
            r.fit_ms = Some(*ms);
        }
        if let Some(file) = &self.report {
            self.write_report(file, &fitted, &summary, registry)?;
        }
        if self.json {
            summary.notes.extend(fitted.notes);
            print_json(&summary)?;
        } else {
            warn(&summary.warnings);
            note(&fitted.notes);
            summary.warnings.clear();
            print(&summary.to_text())?;
        }
        Ok(Exit::SUCCESS)
    }

    fn write_report(
        &self,
        file: &Path,
        fitted: &FittedAsset,
        summary: &AssetSummary,
        registry: Registry,
    ) -> Result<(), Failure> {
        let asset = htex::Asset::with_registry(fitted.asset.clone(), registry);
        let sizes = self.recordings.iter().map(std::fs::metadata);
        let reported = Reported {
            fitted,
            asset: &asset,
            summary,
            recording_bytes: sizes.map(|size| size.map_or(0, |m| m.len())).sum(),
        };
        let textures = reported.textures();
        let page = TextureReport {
            title: format!("{}: recording and models", fitted.asset.manifest.name),
            textures: textures.map_err(|error| Failure::asset(&self.output, error))?,
            command: command_line(),
            ..TextureReport::default()
        };
        write_file(file, texture_report(&page).as_bytes())
    }

    /// Puts the modules of fitted models into the asset.
    fn embed(&self, asset: &mut htex_format::Asset, registry: &Registry) -> Result<(), Failure> {
        let secret_key = self.sign_with.as_deref().map(secret_key).transpose()?;
        for file in &self.embed_plugin {
            let of_file =
                |m: &&LoadedModel| matches!(m.origin(), Origin::Wasm(path) if path == file);
            let model = registry.models().iter().find(of_file).ok_or_else(|| {
                let file = file.display();
                Failure::Usage(format!(
                    "--embed-plugin {file}: only WASM modules can be embedded"
                ))
            })?;
            if !asset
                .manifest
                .representations
                .iter()
                .any(|r| r.model == model.id())
            {
                let (file, id) = (file.display(), model.id());
                let sentence =
                    format!("--embed-plugin {file}: {id} was not fitted; add it to --model");
                return Err(Failure::Usage(sentence));
            }
            let module = std::fs::read(file).map_err(|error| Failure::read(file, error))?;
            let mut plugin = Plugin::new(model.id(), &model.descriptor().version, &module);
            if let Some(key) = &secret_key {
                plugin = plugin.signed(key);
            }
            asset.manifest.plugins.push(plugin);
            asset.plugins.push(module);
        }
        Ok(())
    }

    fn request(&self, registry: &Registry) -> Result<AssetRequest, Failure> {
        let mut recorded_options = self.reading.recorded_options();
        for option in &self.option {
            if let Some((name, value)) = option.split_once('=') {
                recorded_options.insert(name.to_owned(), value.to_owned());
            }
        }
        if self.level == LevelArg::Fitted {
            recorded_options.insert("level".to_owned(), "fitted".to_owned());
        }
        let stem = self
            .output
            .file_stem()
            .map(|s| s.to_string_lossy().into_owned());
        Ok(AssetRequest::new(stem.unwrap_or_default())
            .with_models(model_requests(registry, &self.model, &self.option)?)
            .with_spectrum(self.reading.spectrum_options()?)
            .with_level(match self.level {
                LevelArg::Fitted => Level::Fitted,
                LevelArg::Recording => Level::Recording,
            })
            .with_alternatives(alternatives(registry))
            .with_strict(self.reading.strict())
            .with_keep_reference(self.keep_reference)
            .with_recorded_options(recorded_options)
            .with_tool(tool()))
    }
}

/// This run's command line; words with other characters than a path has are quoted.
fn command_line() -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:=,+%@".contains(c);
    let quoted = |word: std::ffi::OsString| match word.to_string_lossy() {
        word if !word.is_empty() && word.chars().all(is_plain) => word.into_owned(),
        word => format!("'{}'", word.replace('\'', r"'\''")),
    };
    let words = invocation::arguments().into_iter().map(quoted);
    let words: Vec<String> = std::iter::once("htex".to_owned()).chain(words).collect();
    words.join(" ")
}

/// The models that come with this program: a plugin runs only where it is asked for.
fn alternatives(registry: &Registry) -> Vec<LoadedModel> {
    let models = registry.models().iter();
    let builtin = models.filter(|model| *model.origin() == Origin::Builtin);
    builtin.cloned().collect()
}

/// Reads an ed25519 secret key.
fn secret_key(file: &Path) -> Result<[u8; 32], Failure> {
    let bytes = std::fs::read(file).map_err(|error| Failure::read(file, error))?;
    let len = bytes.len();
    bytes.try_into().map_err(|_| {
        let file = file.display();
        Failure::Usage(format!(
            "--sign-with {file}: {len} bytes; an ed25519 secret key has 32"
        ))
    })
}
