//! Recordings to a fitted texture.

use htex::host::Registry;
use htex_author::settings::{FitSettings, Metadata};
use htex_author::{AssetRequest, FeltError, FittedAsset, fit_asset_watched};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::TOOL;
use crate::call::{Answer, Files, parsed};
use crate::recordings::{Given, Names, Reading};
use crate::refusal::Refusal;
use crate::settings::Settings;
use crate::{describe, progress};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Call {
    files: Names,
    #[serde(default)]
    conditions: Vec<Given>,
    #[serde(default)]
    settings: Map<String, Value>,
}

/// Fits models to recordings; the bytes are the asset.
pub(crate) fn fit(json: &[u8], files: Files<'_>) -> Result<Answer, Refusal> {
    let call: Call = parsed(json)?;
    let mut settings = Settings::new(call.settings);
    let reading = Reading::new(call.files, &mut settings, files)?;
    let mut fitting: FitSettings = settings.take(FitSettings::NAMES)?;
    let metadata: Metadata = settings.take(Metadata::NAMES)?;
    settings.finish()?;
    metadata.check()?;
    fitting.strict = Some(reading.strict);
    let registry = Registry::builtin();
    let request = request(&reading, &fitting, &metadata, &registry)?;
    progress::start(reading.count() + request.models.len());
    let fitted = fitted(&reading, &call.conditions, &request);
    progress::end();
    let mut fitted = fitted?;
    metadata.apply(&mut fitted.asset.manifest);
    Answer::new(&report(&fitted), fitted.asset.to_bytes()?)
}

fn request(
    reading: &Reading<'_>,
    fitting: &FitSettings,
    metadata: &Metadata,
    registry: &Registry,
) -> Result<AssetRequest, Refusal> {
    let name = metadata.name.clone().or_else(|| reading.stem());
    let name = name.unwrap_or_else(|| "texture".to_owned());
    let mut request = fitting.request(registry, &reading.settings, &name, TOOL)?;
    request.spectrum = reading.spectrum.clone();
    if let Some(response) = &reading.response {
        let recorded = ("frf".to_owned(), response.clone());
        request.recorded_options.extend([recorded]);
    }
    Ok(request)
}

fn fitted(
    reading: &Reading<'_>,
    conditions: &[Given],
    request: &AssetRequest,
) -> Result<FittedAsset, Refusal> {
    let takes = reading.takes(conditions)?;
    let fitted = fit_asset_watched(&takes, request, &mut |model| {
        progress::begin("fit", model.short_name());
    });
    Ok(fitted?)
}

/// What the file of a fitted texture does not hold, and what ranks its models.
fn report(fitted: &FittedAsset) -> Value {
    let manifest = &fitted.asset.manifest;
    let models = manifest
        .representations
        .iter()
        .enumerate()
        .map(|(i, representation)| {
            let felt = fitted.felt.get(i).map_or(&[][..], Vec::as_slice);
            let at = representation.at.iter().enumerate().map(|(k, at)| {
                json!({
                    "condition": at.condition,
                    "level_rms": at.level_rms,
                    "quality": at.quality,
                    "left_out": at.left_out,
                    "felt": felt.get(k),
                })
            });
            json!({
                "model": representation.model,
                "bytes": fitted.asset.payload_bytes(i),
                "fit_ms": fitted.fit_ms.get(i),
                "felt": worst(felt),
                "at": at.collect::<Vec<_>>(),
            })
        });
    let skipped = fitted
        .skipped
        .iter()
        .map(|(model, reason)| json!({ "model": model, "reason": reason }));
    let findings = fitted.findings.iter().map(|found| {
        json!({ "recording": found.recording, "finding": describe::finding(&found.finding) })
    });
    json!({
        "models": models.collect::<Vec<_>>(),
        "ranked": ranked(fitted),
        "skipped": skipped.collect::<Vec<_>>(),
        "conditions": manifest.conditions,
        "spectra": fitted.spectra.iter().map(describe::spectrum).collect::<Vec<_>>(),
        "findings": findings.collect::<Vec<_>>(),
        "warnings": describe::notices(&fitted.warnings),
        "notes": describe::notices(&fitted.notes),
        "grid": fitted.grid,
    })
}

/// What is felt at the condition where most is.
fn worst(felt: &[Option<FeltError>]) -> Option<FeltError> {
    felt.iter().flatten().copied().reduce(FeltError::worse)
}

/// The models, that of which least is felt first.
fn ranked(fitted: &FittedAsset) -> Vec<&str> {
    let representations = fitted.asset.manifest.representations.iter();
    let mut all: Vec<(&str, f64)> = representations
        .zip(&fitted.felt)
        .map(|(representation, felt)| {
            let error_db = worst(felt).map_or(f64::INFINITY, |felt| felt.error_rms_db);
            (representation.model.as_str(), error_db)
        })
        .collect();
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    all.into_iter().map(|(model, _)| model).collect()
}
