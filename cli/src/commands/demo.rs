use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};

use clap::Args;
use htex::VoiceOptions;
use htex_author::recording::{ReadOptions, read_recording};
use htex_author::report::{Share, Texture, TextureReport, spectra_picture, texture_report};
use htex_author::settings::FitSettings;
use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{
    AssetRequest, Exploration, FeltError, SetupResponse, SpectrumOptions, Take, fit_asset,
};
use htex_base::files::{AtFile, OwnFolder};
use htex_format::{By, HeldOut, KeyedMeasures, Measure, Rights};
use htex_host::Registry;
use serde::Serialize;

use super::simulate::write_response;
use crate::assets::{AssetSummary, RepresentationSummary, short_name};
use crate::columns::{cells, columns, headings};
use crate::failure::{Failure, Result, for_file};
use crate::invocation::tool;
use crate::output::{OutputFile, show};
use crate::progress::bar;
use crate::report::{ReportSource, measures, shares};
use crate::wav::write_wav;

const WAV_RATE_HZ: u32 = 20_000;
const WAV_SECONDS: u64 = 5;
/// The models shown in the picture of all spectra.
const PICTURED: [&str; 2] = ["bands", "ar"];
/// File name of the simulated rig's response.
const RIG: &str = "rig.csv";
const REPORT: &str = "report.html";
/// The speed and force at which the surfaces are explored (paper, Texture recording).
const CONDITION: Exploration = Exploration { speed_mm_s: Some(80.0), force_n: Some(0.4) };

/// Try everything on five simulated surfaces
///
/// Simulates recordings, fits the six models that `htex fit` fits by default, plays the assets to
/// WAV files, and writes a report.
///
/// For each surface, the command writes to DIR the simulated recording (NAME.csv), the asset
/// (NAME.htex), and 5 s of the signal of each model (NAME-MODEL.wav). For all surfaces together,
/// the command writes report.html, spectra.svg and rig.csv. spectra.svg shows the spectra of the
/// recordings, and the spectra of the models Bands and AR. rig.csv is the frequency response of the
/// simulated rig; htex divides the spectra of the recordings by this response.
///
/// The samples in the WAV files are forces in newtons, as 32-bit floats, so the files sound very
/// quiet. To listen to a file, raise its level in an audio editor.
#[derive(Args)]
pub(crate) struct Demo {
    /// Folder to write to; created if it does not exist
    dir: PathBuf,

    /// Seed of the simulated recordings
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Demo {
    pub(crate) fn run(self) -> Result {
        let own = OwnFolder::new(&self.dir);
        own.make_folder(Path::new("")).writing(&self.dir)?;
        let inside =
            |name: &str, bytes: &[u8]| OutputFile::Inside(&own, name.as_ref()).write(bytes);
        let rig =
            SimulationOptions::new(Surface::Sandpaper).setup_response().map_err(Failure::other)?;
        write_response(&rig, OutputFile::Inside(&own, RIG.as_ref()))?;
        let bar = bar(Surface::ALL.len() as u64);
        let mut done = Vec::new();
        for surface in Surface::ALL {
            bar.set_message(surface.to_string());
            done.push(self.texture(&own, surface, &rig)?);
            bar.inc(1);
        }
        bar.finish_and_clear();
        let report = self.dir.join(REPORT);
        let rows = done.iter().flat_map(DemoTexture::rows).collect();
        let shares = shares(done.iter().map(|d| &d.summary));
        let textures: Vec<Texture> = done.into_iter().map(|d| d.texture).collect();
        let picture = spectra_picture(&textures, &PICTURED);
        inside("spectra.svg", picture.as_bytes())?;
        let page = texture_report(&self.page(textures, shares));
        inside(REPORT, page.as_bytes())?;
        show(&Table { rows, report }, self.json)
    }

    /// Simulates, fits, validates and plays one surface.
    fn texture(
        &self,
        own: &OwnFolder,
        surface: Surface,
        rig: &SetupResponse,
    ) -> Result<DemoTexture> {
        let name = surface.to_string();
        let csv = PathBuf::from(format!("{name}.csv"));
        self.write_recording(surface, OutputFile::Inside(own, &csv))?;
        let csv = self.dir.join(csv);
        // Reads the files back, so that the demo handles them exactly as a user's files.
        let recording = read_recording(&csv, &ReadOptions::default())?;
        let take = Take { recording, given: CONDITION };
        let fitted = fit_asset(&[take], &request(&name, rig)?)?;
        let path = PathBuf::from(format!("{name}.htex"));
        let bytes = fitted.asset.to_bytes()?;
        OutputFile::Inside(own, &path).write(&bytes)?;
        let path = self.dir.join(path);
        let asset = htex::Texture::open(&path).map_err(for_file(&path))?;
        for representation in &asset.manifest().representations {
            let wav = format!("{name}-{}.wav", short_name(&representation.model));
            let wav = OutputFile::Inside(own, wav.as_ref());
            play(&asset, &representation.model, &path, wav)?;
        }
        let summary =
            AssetSummary::new(&path, bytes.len() as u64, &fitted.asset).with_felt(&fitted.felt);
        let recording_bytes = std::fs::metadata(&csv).map_or(0, |m| m.len());
        let reported =
            ReportSource { fitted: &fitted, asset: &asset, summary: &summary, recording_bytes };
        let texture = reported.texture(0).map_err(for_file(&path))?;
        Ok(DemoTexture { texture, summary })
    }

    fn write_recording(&self, surface: Surface, csv: OutputFile<'_>) -> Result<()> {
        let options = SimulationOptions::new(surface).with_seed(self.seed);
        let simulation = simulate(&options).map_err(Failure::other)?;
        let write =
            |file: &mut std::fs::File| simulation.write_csv(&mut std::io::BufWriter::new(file));
        Ok(csv.replace(write)?)
    }

    fn page(&self, textures: Vec<Texture>, shares: Vec<Share>) -> TextureReport {
        TextureReport {
            title: format!(
                "{} simulated surfaces, {} models",
                Surface::ALL.len(),
                Registry::builtin().by_default().count()
            ),
            intro: vec![
                "Recordings come from a simulator of a finger sliding to and fro, not from a \
                 finger: they show the way of the data, not the quality of the models on real \
                 surfaces."
                    .to_owned(),
            ],
            measures: measures(),
            textures,
            shares,
            pictures: Vec::new(),
            command: format!("htex demo {} --seed {}", self.dir.display(), self.seed),
        }
    }
}

struct DemoTexture {
    texture: Texture,
    summary: AssetSummary,
}

#[derive(Serialize)]
struct Row {
    texture: String,
    model: String,
    #[serde(flatten)]
    held_out: Option<HeldOut>,
    #[serde(flatten)]
    by_magnitude: KeyedMeasures,
    felt: Option<FeltError>,
    #[serde(flatten)]
    by_samples: KeyedMeasures,
    /// The measures, formatted as table cells.
    #[serde(skip)]
    cells: String,
    repeatability_rms_db: Option<f64>,
    payload_bytes: usize,
    asset_bytes: u64,
    recording_bytes: u64,
}

impl DemoTexture {
    /// Returns a row for each model, at the first condition.
    fn rows(&self) -> Vec<Row> {
        let AssetSummary { manifest, representations, bytes, .. } = &self.summary;
        let row = |(index, r): (usize, &RepresentationSummary)| {
            let (stated, at) = self.summary.conditions(index).next()?;
            let quality = stated.quality.clone().unwrap_or_default();
            let own = shown().filter(|m| m.row().column.is_some());
            let played = shown().filter(|m| m.row().played.is_some());
            Some(Row {
                texture: self.texture.name.clone(),
                model: short_name(&r.model).to_owned(),
                held_out: at.held_out,
                by_magnitude: quality.by_magnitude.keyed(By::Magnitude, own),
                felt: at.felt,
                by_samples: quality.by_samples.keyed(By::Samples, played),
                cells: cells(&columns(shown()), |column| at.measured(stated, column)),
                repeatability_rms_db: manifest.conditions[0].repeatability_rms_db,
                payload_bytes: r.payload_bytes,
                asset_bytes: *bytes,
                recording_bytes: self.texture.recording_bytes,
            })
        };
        representations.iter().enumerate().filter_map(row).collect()
    }
}

fn request(name: &str, rig: &SetupResponse) -> Result<AssetRequest> {
    let mut request = AssetRequest::new(name)
        .with_models(FitSettings::default().models(&Registry::builtin())?)
        .with_spectrum(SpectrumOptions::default().with_response(rig.clone()));
    request.license = Some("CC0-1.0".to_owned());
    request.author = Some("htex demo".to_owned());
    request.tags = vec!["simulated".to_owned()];
    request.recorded_options = BTreeMap::from([("frf".to_owned(), RIG.to_owned())]);
    request.tool = tool();
    Ok(request)
}

fn play(asset: &htex::Texture, model: &str, file: &Path, wav: OutputFile<'_>) -> Result<()> {
    let options = VoiceOptions::default().with_rate_hz(f64::from(WAV_RATE_HZ));
    let representation = asset.representation(model).map_err(for_file(file))?;
    let mut voice = representation.voice(&options).map_err(for_file(file))?;
    let frames = WAV_SECONDS * u64::from(WAV_RATE_HZ);
    let rights = Rights::from_manifest(asset.manifest());
    write_wav(wav, WAV_RATE_HZ, frames, &rights, |block| {
        voice.render(block).map_err(for_file(file))
    })
}

/// Returns the measures shown in the table.
fn shown() -> impl Iterator<Item = Measure> {
    Measure::of_both().filter(|m| m.row().stored)
}

/// The result of the demonstration.
#[derive(Serialize)]
#[serde(transparent)]
struct Table {
    rows: Vec<Row>,
    #[serde(skip)]
    report: PathBuf,
}

impl Display for Table {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let measures = headings(&columns(shown()));
        writeln!(
            f,
            "texture           model {measures}  repeats/dB  parameters/B  asset/B  recording/B"
        )?;
        for r in &self.rows {
            let repeats = r.repeatability_rms_db.map_or("-".to_owned(), |x| format!("{x:.2}"));
            writeln!(
                f,
                "{:16}  {:6}{}  {repeats:>10}  {:>12}  {:>7}  {:>11}",
                r.texture, r.model, r.cells, r.payload_bytes, r.asset_bytes, r.recording_bytes
            )?;
        }
        writeln!(f, "\nThe report, with the spectra: {}", self.report.display())
    }
}
