use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use htex::VoiceOptions;
use htex_author::recording::{ReadOptions, read_recording};
use htex_author::settings::FitSettings;
use htex_author::{
    AssetRequest, AuthorError, Exploration, FeltError, SetupResponse, SpectrumOptions, Take,
    fit_asset,
};
use htex_host::Registry;
use htex_report::{Share, Texture, TextureReport, spectra_picture, texture_report};
use htex_simulate::{SimulationError, SimulationOptions, Surface, simulate};
use serde::Serialize;

use super::simulate::write_response;
use crate::assets::{AssetSummary, RepresentationSummary, short_name};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::models::tool;
use crate::output::{print, print_json, write_file};
use crate::progress::bar;
use crate::report::{Reported, shares};
use crate::wav::write_wav;

const WAV_RATE_HZ: u32 = 20_000;
const WAV_SECONDS: u64 = 5;
/// The models in the picture of all spectra.
const PICTURED: [&str; 2] = ["bands", "ar"];
/// The simulated rig's response.
const RIG: &str = "rig.csv";
/// The condition the surfaces are explored at (paper, Texture recording).
const CONDITION: Exploration = Exploration {
    speed_mm_s: Some(80.0),
    force_n: Some(0.4),
};

/// Run the whole way on five simulated surfaces: recordings, assets, sounds and a report.
///
/// Needs nothing but this program. Writes NAME.csv (the simulated recording), NAME.htex,
/// NAME-MODEL.wav, rig.csv (the simulated rig's response, by which recordings are divided), report.html and spectra.svg
/// (all recordings, with Bands and AR over them) into DIR.
#[derive(Args)]
pub(crate) struct Demo {
    /// Folder to write to; created if it does not exist
    dir: PathBuf,

    /// Seed of the simulated recordings
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

impl Demo {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        std::fs::create_dir_all(&self.dir).map_err(|error| Failure::write(&self.dir, error))?;
        let rig = SimulationOptions::new(Surface::Sandpaper)
            .setup_response()
            .map_err(simulation_failure)?;
        write_response(&rig, &self.dir.join(RIG))?;
        let bar = bar(Surface::ALL.len() as u64);
        let mut done = Vec::new();
        for surface in Surface::ALL {
            bar.set_message(surface.to_string());
            done.push(self.texture(surface, &rig)?);
            bar.inc(1);
        }
        bar.finish_and_clear();
        let report = self.dir.join("report.html");
        let rows: Vec<Row> = done.iter().flat_map(DemoTexture::rows).collect();
        let shares = shares(done.iter().map(|d| &d.summary));
        let textures: Vec<Texture> = done.into_iter().map(|d| d.texture).collect();
        let picture = spectra_picture(&textures, &PICTURED);
        write_file(&self.dir.join("spectra.svg"), picture.as_bytes())?;
        write_file(
            &report,
            texture_report(&self.page(textures, shares)).as_bytes(),
        )?;
        if self.json {
            print_json(&rows)?;
        } else {
            print(&table(&rows))?;
            print(&format!(
                "\nThe report, with the spectra: {}\n",
                report.display()
            ))?;
        }
        Ok(Exit::SUCCESS)
    }

    /// Simulates, fits, validates and plays one surface.
    fn texture(&self, surface: Surface, rig: &SetupResponse) -> Result<DemoTexture, Failure> {
        let name = surface.to_string();
        let csv = self.dir.join(format!("{name}.csv"));
        self.write_recording(surface, &csv)?;
        let recording = read_recording(&csv, &ReadOptions::default())?;
        let take = Take {
            recording,
            given: CONDITION,
        };
        let fitted = fit_asset(&[take], &request(&name, rig)?)?;
        let path = self.dir.join(format!("{name}.htex"));
        let bytes = fitted.asset.to_bytes().map_err(AuthorError::from)?;
        write_file(&path, &bytes)?;
        let asset = htex::Asset::open(&path).map_err(|error| Failure::asset(&path, error))?;
        for representation in &asset.manifest().representations {
            let wav = self
                .dir
                .join(format!("{name}-{}.wav", short_name(&representation.model)));
            play(&asset, &representation.model, &path, &wav)?;
        }
        let summary =
            AssetSummary::new(&path, bytes.len() as u64, &fitted.asset).with_felt(&fitted.felt);
        let recording_bytes = std::fs::metadata(&csv).map_or(0, |m| m.len());
        let reported = Reported {
            fitted: &fitted,
            asset: &asset,
            summary: &summary,
            recording_bytes,
        };
        let texture = reported
            .texture(0)
            .map_err(|error| Failure::asset(&path, error))?;
        Ok(DemoTexture { texture, summary })
    }

    fn write_recording(&self, surface: Surface, csv: &Path) -> Result<(), Failure> {
        let options = SimulationOptions::new(surface).with_seed(self.seed);
        let simulation = simulate(&options).map_err(simulation_failure)?;
        let write =
            |file: &mut std::fs::File| simulation.write_csv(&mut std::io::BufWriter::new(file));
        htex_format::replace_file(csv, write).map_err(|error| Failure::write(csv, error))
    }

    fn page(&self, textures: Vec<Texture>, shares: Vec<Share>) -> TextureReport {
        TextureReport {
            title: "Five simulated surfaces, six models".to_owned(),
            intro: vec![
                "Recordings come from a simulator of a finger sliding to and fro, not from a \
                 finger: they show the way of the data, not the quality of the models on real \
                 surfaces."
                    .to_owned(),
            ],
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
    spectral_correlation: f64,
    band_error_rms_db: f64,
    third_octave_error_rms_db: Option<f64>,
    log_spectral_distance_db: Option<f64>,
    felt: Option<FeltError>,
    samples_band_error_rms_db: Option<f64>,
    repeatability_rms_db: Option<f64>,
    payload_bytes: usize,
    asset_bytes: u64,
    recording_bytes: u64,
}

impl DemoTexture {
    fn rows(&self) -> Vec<Row> {
        let row = |r: &RepresentationSummary| {
            let quality = r.first.quality.as_ref();
            Row {
                texture: self.texture.name.clone(),
                model: short_name(&r.model).to_owned(),
                spectral_correlation: quality.map_or(f64::NAN, |q| q.spectral_correlation),
                band_error_rms_db: quality.map_or(f64::NAN, |q| q.band_error_rms_db),
                third_octave_error_rms_db: quality.and_then(|q| q.third_octave_error_rms_db),
                log_spectral_distance_db: quality.and_then(|q| q.log_spectral_distance_db),
                felt: r.first.felt,
                samples_band_error_rms_db: quality.and_then(|q| q.samples_band_error_rms_db),
                repeatability_rms_db: self.summary.repeatability_rms_db,
                payload_bytes: r.payload_bytes,
                asset_bytes: self.summary.bytes,
                recording_bytes: self.texture.recording_bytes,
            }
        };
        self.summary.representations.iter().map(row).collect()
    }
}

fn simulation_failure(error: SimulationError) -> Failure {
    Failure::Other(error.to_string())
}

fn request(name: &str, rig: &SetupResponse) -> Result<AssetRequest, Failure> {
    Ok(AssetRequest::new(name)
        .with_license("CC0-1.0".to_owned())
        .with_author("htex demo".to_owned())
        .with_tags(vec!["simulated".to_owned()])
        .with_models(FitSettings::default().models(&Registry::builtin())?)
        .with_spectrum(SpectrumOptions::default().with_response(rig.clone()))
        .with_recorded_options(BTreeMap::from([("frf".to_owned(), RIG.to_owned())]))
        .with_tool(tool()))
}

fn play(asset: &htex::Asset, model: &str, file: &Path, wav: &Path) -> Result<(), Failure> {
    let failure = |error| Failure::asset(file, error);
    let options = VoiceOptions::default()
        .with_model(model)
        .with_rate_hz(f64::from(WAV_RATE_HZ));
    let mut voice = asset.voice(&options).map_err(failure)?;
    let frames = WAV_SECONDS * u64::from(WAV_RATE_HZ);
    write_wav(wav, WAV_RATE_HZ, frames, |block| {
        voice.render(block).map_err(failure)
    })
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "texture           model   corr.  bands/dB  third-oct/dB  log-sp/dB  played/dB  repeats/dB  parameters/B  asset/B  \
         recording/B\n",
    );
    for r in rows {
        let db = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.2}"));
        text += &format!(
            "{:16}  {:6}  {:>5.3}  {:>8.2}  {:>12}  {:>9}  {:>9}  {:>10}  {:>12}  {:>7}  {:>11}\n",
            r.texture,
            r.model,
            r.spectral_correlation,
            r.band_error_rms_db,
            db(r.third_octave_error_rms_db),
            db(r.log_spectral_distance_db),
            db(r.samples_band_error_rms_db),
            db(r.repeatability_rms_db),
            r.payload_bytes,
            r.asset_bytes,
            r.recording_bytes
        );
    }
    text
}
