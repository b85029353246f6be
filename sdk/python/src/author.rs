//! Recordings to spectra and textures, and the agreement of spectra.

use std::collections::BTreeMap;
use std::path::PathBuf;

use htex::format::{By, Keyed, Measure};
use htex::host::{Origin, Registry};
use htex::{AssetData, Band};
use htex_author::settings::{FitSettings, Metadata, OptionSetting, SettingsError};
use htex_author::{
    AssetRequest, FittedAsset, Level, SpectrumRef, TextureSpectrum, fit_asset, read_take,
};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::causes;
use crate::errors::{ModelError, OrRaise, option};
use crate::models::registry;
use crate::python::from_json;
use crate::reading::{Pair, Reading, Source, unknown};
use crate::texture::Texture;

/// Program and version, for an asset's provenance: those of the command.
pub(crate) const TOOL: &str = concat!("htex ", env!("CARGO_PKG_VERSION"));

/// Returns the texture spectrum of a recording, with what was read.
#[pyfunction]
pub(crate) fn process(
    py: Python<'_>,
    source: Source,
    reading: Reading,
) -> PyResult<Bound<'_, PyAny>> {
    let value = py.detach(|| processed(source, &reading))?;
    from_json(py, &value)
}

fn processed(source: Source, reading: &Reading) -> PyResult<Value> {
    let options = reading.spectrum_options()?;
    let takes = reading.takes(&[source], &[])?;
    let take = takes.first().ok_or_else(|| option("no recording"))?;
    let read = read_take(take, &options, reading.strict).or_raise()?;
    let part = std::slice::from_ref(&read.part);
    let spectrum = TextureSpectrum::average(part, options.averaging).or_raise()?;
    let recording = &take.recording;
    let stretches = read.part.segments.stretches().into_iter();
    let read_s = stretches.map(|part| [part.start, part.end].map(|at| recording.second(at)));
    Ok(json!({
        "spectrum": described(&spectrum),
        "rate_hz": recording.rate_hz,
        "segments": spectrum.segments,
        "from_sweeps": read.part.segments.from_sweeps,
        "read_s": read_s.collect::<Vec<_>>(),
        "condition": {
            "speed_mm_s": read.condition.speed_mm_s,
            "force_n": read.condition.force_n,
            "repeatability_rms_db": spectrum.repeatability_rms_db,
        },
        "speed_spread_mm_s": read.spread.speed_mm_s,
        "force_spread_n": read.spread.force_n,
        "simulated": recording.simulated,
        "findings": read.findings,
        "warnings": read.warnings,
        "notes": read.notes,
    }))
}

/// The fields of a `Spectrum`.
fn described(spectrum: &TextureSpectrum) -> Value {
    json!({
        "frequency_hz": spectrum.frequency_hz,
        "magnitude": spectrum.magnitude,
        "quantity": spectrum.quantity,
        "unit": spectrum.quantity.unit(),
        "band_hz": [spectrum.band.low_hz, spectrum.band.high_hz],
    })
}

/// Options of a fit: the keywords of the package's function.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Fit {
    models: Vec<String>,
    /// Model, option, value.
    options: Vec<(String, String, String)>,
    conditions: Vec<Pair>,
    level: String,
    keep_reference: bool,
    /// Lines of a grid; empty without one.
    grid: Vec<String>,
    plugins: Vec<PathBuf>,
    installed: bool,
    name: String,
    author: Option<String>,
    license: Option<String>,
    tags: Vec<String>,
    description: Option<String>,
    origin: Option<String>,
    doi: Option<String>,
    sensor: Option<String>,
    finger: Option<String>,
}

/// Fits models to recordings; returns the texture, and what its file does not hold.
#[pyfunction]
pub(crate) fn fit<'py>(
    py: Python<'py>,
    sources: Vec<Source>,
    reading: Reading,
    request: Fit,
) -> PyResult<(Texture, Bound<'py, PyAny>)> {
    let (texture, rest) = py.detach(|| fitted(&sources, &reading, request))?;
    Ok((texture, from_json(py, &rest)?))
}

fn fitted(sources: &[Source], reading: &Reading, fit: Fit) -> PyResult<(Texture, Value)> {
    let registry = registry(&fit.plugins, fit.installed)?;
    let request = fit.request(&registry, reading)?;
    let takes = reading.takes(sources, &fit.conditions)?;
    let mut fitted = fit_asset(&takes, &request).or_raise()?;
    raise_of_python(&registry, &fitted.skipped)?;
    fit.metadata().apply(&mut fitted.asset.manifest);
    let rest = rest(&fitted);
    // The texture is what its file holds: levels and errors have fewer digits there.
    let bytes = fitted.asset.to_bytes().or_raise()?;
    let stored = AssetData::from_bytes(&bytes).or_raise()?;
    Ok((
        Texture::new(stored, fit.plugins, true, fit.installed)?,
        rest,
    ))
}

/// Raises the error of a model that is written in Python: others that cannot be fitted are left out.
fn raise_of_python(registry: &Registry, skipped: &[(String, String)]) -> PyResult<()> {
    for (id, reason) in skipped {
        let model = registry.find(id).or_raise()?;
        if matches!(model.origin(), Origin::Runtime(_)) {
            let text = format!("model {id} cannot be fitted: {reason}");
            return Err(causes::attach(ModelError::new_err(text)));
        }
    }
    Ok(())
}

fn rest(fitted: &FittedAsset) -> Value {
    json!({
        "spectra": fitted.spectra.iter().map(described).collect::<Vec<_>>(),
        "fit_ms": fitted.fit_ms,
        "skipped": fitted.skipped,
        "notes": fitted.notes,
        "felt": fitted.felt,
        "grid": fitted.grid,
    })
}

impl Fit {
    fn request(&self, registry: &Registry, reading: &Reading) -> PyResult<AssetRequest> {
        let level = match &self.level[..] {
            "recording" => Level::Recording,
            "fitted" => Level::Fitted,
            other => return Err(unknown("level", other, "recording, fitted")),
        };
        let option = |(model, name, value): &(String, String, String)| {
            let value = OptionSetting::Text(value.clone());
            (format!("{model}.{name}"), value)
        };
        let settings = FitSettings {
            models: Some(self.models.clone()),
            options: self.options.iter().map(option).collect(),
            level: Some(level),
            keep_reference: Some(self.keep_reference),
            strict: Some(reading.strict),
            grid: Some(self.grid.clone()).filter(|lines| !lines.is_empty()),
        };
        let request = settings.request(registry, &reading.settings()?, &self.name, TOOL);
        request.map_err(|error| match error {
            SettingsError::ModelNotFitted { model, fitted, .. } => {
                unknown("a model in options", &model, &fitted.join(", "))
            }
            other => reading.raised(other),
        })
    }

    /// Returns the texture's metadata.
    fn metadata(&self) -> Metadata {
        Metadata {
            name: None,
            author: self.author.clone(),
            license: self.license.clone(),
            description: self.description.clone(),
            tags: Some(self.tags.clone()),
            source: self.origin.clone(),
            doi: self.doi.clone(),
            sensor: self.sensor.clone(),
            finger: self.finger.clone(),
        }
    }
}

/// Compares magnitudes with those of a reference at the same frequencies.
#[pyfunction]
pub(crate) fn agreement<'py>(
    py: Python<'py>,
    frequency_hz: Vec<f64>,
    band_hz: (f64, f64),
    reference: Vec<f64>,
    magnitude: Vec<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let band = Band {
        low_hz: band_hz.0,
        high_hz: band_hz.1,
    };
    check(&frequency_hz, band, &reference, &magnitude)?;
    let reference = SpectrumRef {
        band,
        frequency_hz: &frequency_hz,
        magnitude: &reference,
    };
    let found = py.detach(|| htex_author::agreement(reference, &magnitude));
    let Keyed(measures) = found.measures.keyed(By::Magnitude, Measure::stored());
    let mut fields: BTreeMap<_, Value> = measures
        .into_iter()
        .map(|(key, value)| (key, value.into()))
        .collect();
    fields.insert("band_error_db".into(), found.band_error_db.into());
    fields.insert("matching_gain_db".into(), found.matching_gain_db.into());
    from_json(py, &fields)
}

/// Refuses spectra that cannot be compared.
fn check(frequency_hz: &[f64], band: Band, reference: &[f64], magnitude: &[f64]) -> PyResult<()> {
    let (frequencies, expected, got) = (frequency_hz.len(), reference.len(), magnitude.len());
    if frequencies == 0 || frequencies != expected || frequencies != got {
        return Err(option(format!(
            "{frequencies} frequencies, {expected} magnitudes of the reference and {got} to compare; \
             give equally many, at least one"
        )));
    }
    let is_band = band.low_hz > 0.0 && band.low_hz < band.high_hz && band.high_hz <= 20_000.0;
    if !is_band {
        let (low, high) = band.edges();
        return Err(option(format!(
            "the band is {low} to {high} Hz; its edges ascend, above 0 and up to 20,000 Hz"
        )));
    }
    let ascend = frequency_hz.windows(2).all(|pair| pair[0] < pair[1]);
    if !(ascend && frequency_hz[0] > 0.0 && frequency_hz[frequencies - 1].is_finite()) {
        return Err(option("frequencies must be finite, above 0 and ascending"));
    }
    let is_magnitude = |m: &f64| (0.0..=1e12).contains(m);
    match reference.iter().chain(magnitude).all(is_magnitude) {
        true => Ok(()),
        false => Err(option(
            "magnitudes must be 0 to 1e12; one is not, or is not a number",
        )),
    }
}
