//! The input for all programs: one simulated surface, its spectrum, and the models fitted to it.

use std::path::{Path, PathBuf};

use htex::Registry;
use htex_author::recording::{ReadOptions, read_recording};
use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{
    AssetRequest, ModelRequest, SpectrumOptions, Take, TextureSpectrum, fit_asset, segment_spectra,
};
use htex_host::{FitCondition, FitInput};
use serde_json::json;

/// The case, and the folder with its files for the other programs.
pub(crate) struct Case {
    pub folder: PathBuf,
    pub registry: Registry,
    pub spectrum: TextureSpectrum,
    /// The fitted asset's bytes.
    pub asset: Vec<u8>,
    /// Parameters by the model's short name.
    parameters: Vec<(String, Vec<f64>)>,
}

type Failure = Box<dyn std::error::Error>;

impl Case {
    /// Makes the case and writes `recording.csv`, `case.json` and `asset.htex`.
    pub(crate) fn new(folder: &Path) -> Result<Self, Failure> {
        let recorded = simulate(&SimulationOptions::new(Surface::Sandpaper))?;
        let csv = folder.join("recording.csv");
        recorded.write_csv(&mut std::io::BufWriter::new(std::fs::File::create(&csv)?))?;
        let recording = read_recording(&csv, &ReadOptions::default())?;
        let spectra = segment_spectra(&recording, &SpectrumOptions::default())?;
        let spectrum = TextureSpectrum::average(&[spectra], Default::default())?;
        let registry = Registry::builtin();
        let mut parameters = Vec::new();
        for model in registry.models() {
            let options = model.options(&[])?;
            let fit = model.fit(&request(&spectrum, &options))?;
            parameters.push((model.short_name().to_owned(), fit.parameters));
        }
        let asset = asset(&registry, recording)?;
        std::fs::write(folder.join("asset.htex"), &asset)?;
        let case = Self { folder: folder.to_owned(), registry, spectrum, asset, parameters };
        std::fs::write(folder.join("case.json"), case.json().to_string())?;
        Ok(case)
    }

    /// A model's parameters, in the flat form of the ABI.
    pub(crate) fn parameters(&self, model: &str) -> &[f64] {
        let found = self.parameters.iter().find(|(name, _)| name == model);
        found.map_or(&[], |(_, parameters)| parameters)
    }

    /// The coefficients of the all-pole filter.
    pub(crate) fn ar(&self) -> &[f64] {
        self.list("ar", 0)
    }

    /// The list that begins at an index in a model's flat parameters.
    fn list(&self, model: &str, at: usize) -> &[f64] {
        let flat = self.parameters(model);
        let len = flat.get(at).map_or(0, |len| *len as usize);
        flat.get(at + 1..at + 1 + len).unwrap_or_default()
    }

    /// The JSON file that the other programs read.
    fn json(&self) -> serde_json::Value {
        let lines = self.list("speak", 0);
        json!({
            "magnitude": self.spectrum.magnitude,
            "signal": self.spectrum.signal,
            "ar": self.ar(),
            "sslope": self.parameters("sslope"),
            "sbeta": self.parameters("sbeta"),
            "mfcc": self.list("mfcc", 0),
            "speak": [lines, self.list("speak", 1 + lines.len())],
        })
    }
}

/// The input of a fit.
pub(crate) fn request<'a>(spectrum: &'a TextureSpectrum, options: &'a [f64]) -> FitInput<'a> {
    FitInput {
        band: spectrum.band,
        frequency_hz: &spectrum.frequency_hz,
        magnitude: &spectrum.magnitude,
        signal: &spectrum.signal,
        signal_rate_hz: spectrum.signal_rate_hz,
        options,
        condition: FitCondition::default(),
    }
}

/// An asset with all models, made as `htex fit` makes it.
fn asset(registry: &Registry, recording: htex_author::Recording) -> Result<Vec<u8>, Failure> {
    let mut models = Vec::new();
    for model in registry.by_default() {
        let options = model.options(&[])?;
        let model = model.clone();
        models.push(ModelRequest::new(&model).with_options(options));
    }
    let take = Take { recording, given: Default::default() };
    let wanted = AssetRequest::new("sandpaper").with_models(models);
    Ok(fit_asset(&[take], &wanted)?.asset.to_bytes()?)
}
