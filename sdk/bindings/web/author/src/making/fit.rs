//! Fits models to recordings to make a texture.

use htex::model::Registry;
use htex_author::settings::{FitSettings, Metadata};
use htex_author::{AssetRequest, FittedAsset, GridReport, fit_asset_watched};
use htex_format::Condition;
use serde::Serialize;

use super::TOOL;
use super::describe::{self, DescribedFinding, DescribedNotice, DescribedSpectrum};
use super::progress;
use super::recordings::{GivenCondition, Reading, given};
use super::represented::{Model, ranked, represented};
use crate::answer::{Answer, Files};
use crate::document::Document;
use crate::refusal::Refusal;

/// Fits models to recordings. The bytes of the answer are the asset.
pub(crate) fn fit(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let names = call.object("files")?;
    let conditions = call
        .list("conditions")?
        .into_iter()
        .map(given)
        .collect::<Result<Vec<GivenCondition>, _>>()?;
    let mut settings = call.object("settings")?;
    call.finish()?;
    let reading = Reading::new(names, &mut settings, files)?;
    let mut fitting: FitSettings = settings.table(FitSettings::NAMES)?;
    let metadata: Metadata = settings.table(Metadata::NAMES)?;
    settings.finish()?;
    metadata.check()?;
    // `Reading` has taken this key, which is in both tables.
    fitting.strict = Some(reading.strict);
    let registry = Registry::builtin();
    let request = request(&reading, &fitting, &metadata, &registry)?;
    progress::start(reading.count() + request.models.len());
    let fitted = fitted(&reading, &conditions, &request);
    // Called before an error returns, because the next call must not report the steps of this call.
    progress::end();
    let mut fitted = fitted?;
    metadata.apply(&mut fitted.asset.manifest);
    Answer::new(&Report::new(&fitted), fitted.asset.to_bytes()?)
}

fn request(
    reading: &Reading<'_>,
    fitting: &FitSettings,
    metadata: &Metadata,
    registry: &Registry,
) -> Result<AssetRequest, Refusal> {
    let name =
        metadata.name.clone().or_else(|| reading.stem()).unwrap_or_else(|| "texture".to_owned());
    let request = fitting.request(registry, &reading.settings, &name, TOOL)?;
    let mut request = request.with_law_of(metadata);
    request.spectrum = reading.spectrum.clone();
    if let Some(response) = &reading.response {
        let recorded = &mut request.recorded_options;
        recorded.insert("frf".to_owned(), response.clone());
    }
    Ok(request)
}

fn fitted(
    reading: &Reading<'_>,
    conditions: &[GivenCondition],
    request: &AssetRequest,
) -> Result<FittedAsset, Refusal> {
    let takes = reading.takes(conditions)?;
    let fitted = fit_asset_watched(&takes, request, &mut |model| {
        progress::begin("fit", model.short_name());
    });
    Ok(fitted?)
}

/// The results of a fit that the file of the texture does not contain, and the ranking of its
/// models.
#[derive(Serialize)]
struct Report<'a> {
    models: Vec<Model<'a>>,
    ranked: Vec<&'a str>,
    skipped: Vec<SkippedModel<'a>>,
    conditions: &'a [Condition],
    spectra: Vec<DescribedSpectrum<'a>>,
    findings: Vec<Found<'a>>,
    warnings: Vec<DescribedNotice<'a>>,
    notes: Vec<DescribedNotice<'a>>,
    grid: Option<&'a GridReport>,
}

#[derive(Serialize)]
struct SkippedModel<'a> {
    model: &'a str,
    reason: &'a str,
}

#[derive(Serialize)]
struct Found<'a> {
    recording: &'a str,
    finding: DescribedFinding<'a>,
}

impl<'a> Report<'a> {
    fn new(fitted: &'a FittedAsset) -> Self {
        let manifest = &fitted.asset.manifest;
        let skipped = fitted.skipped.iter();
        let findings = fitted.findings.iter();
        let mut models = represented(&fitted.asset, &fitted.felt);
        for (model, fit_ms) in models.iter_mut().zip(&fitted.fit_ms) {
            model.fit_ms = Some(*fit_ms);
        }
        Self {
            ranked: ranked(&models),
            models,
            skipped: skipped.map(|(model, reason)| SkippedModel { model, reason }).collect(),
            conditions: &manifest.conditions,
            spectra: fitted.spectra.iter().map(describe::spectrum).collect(),
            findings: findings
                .map(|found| Found {
                    recording: &found.recording,
                    finding: describe::finding(&found.finding),
                })
                .collect(),
            warnings: describe::notices(&fitted.warnings),
            notes: describe::notices(&fitted.notes),
            grid: fitted.grid.as_ref(),
        }
    }
}
