//! Computes spectra and textures from recordings, and measures the agreement of two spectra.

use std::collections::BTreeMap;
use std::path::PathBuf;

use htex::format::{By, KeyedMeasures, Measure};
use htex::model::Band;
use htex::model::{Origin, Registry};
use htex_author::settings::{FitSettings, Metadata};
use htex_author::{
    AssetRequest, AuthorError, Exploration, FittedAsset, SpectrumRef, TextureSpectrum, fit_asset,
};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;
use serde_json::{Value, json};

use crate::causes;
use crate::errors::{ModelError, option, raised};
use crate::models::registry;
use crate::python::{from_json, parsed};
use crate::reading::{Pair, Reading, ReadingText, Source, unknown};
use crate::texture::Texture;

/// Program and version for the provenance of assets. It is the same text that the command writes.
pub(crate) const TOOL: &str = concat!("htex ", env!("CARGO_PKG_VERSION"));

/// Returns the texture spectrum of a recording, and information about how it was read.
#[pyfunction]
pub(crate) fn process(
    py: Python<'_>,
    source: Source,
    reading: ReadingText,
) -> PyResult<Bound<'_, PyAny>> {
    let reading = Reading::new(&reading)?;
    let value = py.detach(|| processed(source, &reading))?;
    from_json(py, &value)
}

fn processed(source: Source, reading: &Reading) -> PyResult<Value> {
    let (recording, read, spectrum) = reading.spectrum(source)?;
    let stretches = read.spectra.segments.stretches().into_iter();
    let read_s = stretches.map(|part| [part.start, part.end].map(|at| recording.second(at)));
    Ok(json!({
        "spectrum": described(&spectrum),
        "rate_hz": recording.rate_hz,
        "segments": spectrum.segments,
        "from_sweeps": read.spectra.segments.from_sweeps,
        "read_s": read_s.collect::<Vec<_>>(),
        "condition": condition(read.motion, &spectrum),
        "speed_spread_mm_s": read.spread.speed_mm_s,
        "force_spread_n": read.spread.force_n,
        "simulated": recording.simulated,
        "findings": read.findings,
        "warnings": read.warnings,
        "notes": read.notes,
    }))
}

/// The fields of a `Condition`.
pub(crate) fn condition(found: Exploration, spectrum: &TextureSpectrum) -> Value {
    json!({
        "speed_mm_s": found.speed_mm_s,
        "force_n": found.force_n,
        "repeatability_rms_db": spectrum.repeatability_rms_db(),
    })
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

/// Which models are fitted, and how: keywords of the package's function `fit`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Fit {
    /// JSON, as is `metadata`.
    settings: PyBackedStr,
    metadata: PyBackedStr,
    conditions: Vec<Pair>,
    plugins: Vec<PathBuf>,
    installed: bool,
}

/// Fits models to recordings. Returns the texture, and information that its file does not contain.
#[pyfunction]
pub(crate) fn fit<'py>(
    py: Python<'py>,
    sources: Vec<Source>,
    reading: ReadingText,
    request: Fit,
) -> PyResult<(Texture, Bound<'py, PyAny>)> {
    let reading = Reading::new(&reading)?;
    let (texture, rest) = py.detach(|| fitted(&sources, &reading, request))?;
    Ok((texture, from_json(py, &rest)?))
}

fn fitted(sources: &[Source], reading: &Reading, fit: Fit) -> PyResult<(Texture, Value)> {
    let registry = registry(&fit.plugins, fit.installed)?;
    let metadata: Metadata = parsed(&fit.metadata)?;
    let request = fit.request(&registry, reading, &metadata)?;
    let takes = reading.takes(sources, &fit.conditions)?;
    let mut fitted = fit_asset(&takes, &request).map_err(raised)?;
    raise_of_python(&registry, &fitted.skipped)?;
    metadata.apply(&mut fitted.asset.manifest);
    let rest = rest(&fitted);
    let texture = Texture::from_asset(&fitted.asset, fit.plugins, fit.installed)?;
    Ok((texture, rest))
}

/// Raises the error of a model that is written in Python. Any other model that cannot be fitted is
/// left out instead.
fn raise_of_python(registry: &Registry, skipped: &[(String, String)]) -> PyResult<()> {
    for (id, reason) in skipped {
        let model = registry.find(id).map_err(raised)?;
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
    fn request(
        &self,
        registry: &Registry,
        reading: &Reading,
        metadata: &Metadata,
    ) -> PyResult<AssetRequest> {
        let settings = FitSettings { strict: Some(reading.strict()), ..parsed(&self.settings)? };
        let name = metadata.name.as_deref().unwrap_or("texture");
        let request = settings.request(registry, reading.settings(), name, TOOL);
        request.map(|request| request.with_law_of(metadata)).map_err(|error| match error {
            AuthorError::ModelNotFitted { model, fitted, .. } => {
                unknown("a model in options", &model, &fitted.join(", "))
            }
            other => reading.raised(other),
        })
    }
}

/// Compares magnitudes with the magnitudes of a reference at the same frequencies.
#[pyfunction]
pub(crate) fn agreement<'py>(
    py: Python<'py>,
    frequency_hz: Vec<f64>,
    band_hz: (f64, f64),
    reference: Vec<f64>,
    magnitude: Vec<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let band = Band { low_hz: band_hz.0, high_hz: band_hz.1 };
    check(&frequency_hz, band, &reference, &magnitude)?;
    let reference = SpectrumRef { band, frequency_hz: &frequency_hz, magnitude: &reference };
    let found = py.detach(|| htex_author::agreement(reference, &magnitude));
    let KeyedMeasures(measures) = found.measures.keyed(By::Magnitude, Measure::stored());
    let mut fields: BTreeMap<_, Value> =
        measures.into_iter().map(|(key, value)| (key, value.into())).collect();
    fields.insert("band_error_db", found.band_error_db.into());
    fields.insert("matching_gain_db", found.matching_gain_db.into());
    from_json(py, &fields)
}

/// Returns an error if the spectra cannot be compared.
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
    if reference.iter().chain(magnitude).all(is_magnitude) {
        Ok(())
    } else {
        Err(option("magnitudes must be 0 to 1e12; one is not, or is not a number"))
    }
}
