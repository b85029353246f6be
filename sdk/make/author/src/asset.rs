//! Runs the stages that lead from recordings to a fitted asset. This module also contains the last
//! stage, which puts the asset together.

use std::collections::BTreeMap;

use htex_base::finding::Notice;
use htex_dsp::Band;
use htex_format::{
    Asset, Condition, Contact, Manifest, Provenance, Quantity, Reference, Representation,
};
use htex_host::LoadedModel;

use crate::conditions::{ConditionSpectra, RecordingFinding};
use crate::felt::FeltError;
use crate::fit::{FittedModels, fit_models};
use crate::fluctuation::{SteadyVoice, fluctuation_of_texture, with_held_out_error};
use crate::grid::{GridReport, GridSpectra};
use crate::request::AssetRequest;
use crate::take::{SegmentedTake, Take, segment_take};
use crate::{AuthorError, TextureSpectrum};

/// A fitted asset, with results that its file does not store.
#[derive(Debug, Clone)]
pub struct FittedAsset {
    pub asset: Asset,
    /// Time that the fits of each representation took, milliseconds.
    pub fit_ms: Vec<f64>,
    /// Models that could not be fitted, with the reasons.
    pub skipped: Vec<(String, String)>,
    /// The texture spectrum of each condition.
    pub spectra: Vec<TextureSpectrum>,
    /// How much of the difference between a representation and the recorded spectra can be felt.
    /// There is one list for each representation, with one value for each of the representation's
    /// conditions. The value is `None` if the condition was computed between recorded conditions.
    pub felt: Vec<Vec<Option<FeltError>>>,
    /// The warnings in the asset's provenance, each with the settings that can fix the problem.
    pub warnings: Vec<Notice>,
    /// Notes about the recordings. They are less severe than warnings, and say what was left out
    /// and why.
    pub notes: Vec<Notice>,
    /// All findings about the recordings, in the order of the recordings.
    pub findings: Vec<RecordingFinding>,
    /// The grid of conditions, if one was requested.
    pub grid: Option<GridReport>,
}

/// Fits every model at every condition and returns the asset. Also measures how well the stored
/// (rounded) parameters agree with the recordings.
///
/// A model that cannot be fitted is left out and listed in `skipped`.
///
/// # Errors
/// Returns an error if a recording cannot be used, or no model could be fitted.
pub fn fit_asset(takes: &[Take], request: &AssetRequest) -> Result<FittedAsset, AuthorError> {
    fit_asset_watched(takes, request, &mut |_| {})
}

/// Does the same as [`fit_asset`], and also calls `begins` with each model before the model is
/// fitted.
///
/// # Errors
/// Returns the errors of [`fit_asset`].
pub fn fit_asset_watched(
    takes: &[Take],
    request: &AssetRequest,
    begins: &mut dyn FnMut(&LoadedModel),
) -> Result<FittedAsset, AuthorError> {
    let AssetRequest { spectrum, strict, level, .. } = request;
    let (conditions, grid, blocks) = match &request.grid {
        None => {
            let segmented = takes.iter().map(|take| segment_take(take, spectrum, *strict));
            let segmented = segmented.collect::<Result<Vec<SegmentedTake>, _>>()?;
            let conditions = ConditionSpectra::new(segmented, request)?;
            (conditions, None, Vec::new())
        }
        Some(lines) => {
            let grid = GridSpectra::new(takes, lines, spectrum, *strict)?;
            (grid.conditions, Some(grid.report), grid.left_out)
        }
    };
    let fitted = fit_models(
        &request.models,
        &conditions.all,
        &blocks,
        *level,
        &request.alternatives,
        begins,
    )?;
    let fluctuation = fluctuation_of_texture(takes, spectrum.segments, &conditions.law);
    let fluctuation = match fluctuation.zip(noise(request, &conditions, &fitted)) {
        Some((fluctuation, voice)) => {
            let (segments, law) = (spectrum.segments, &conditions.law);
            Some(with_held_out_error(fluctuation, takes, segments, law, voice)?)
        }
        None => fluctuation,
    };
    let mut fitted = assemble(request, conditions, grid, fitted);
    fitted.asset.manifest.fluctuation = fluctuation;
    Ok(fitted)
}

/// Returns the voice of the first fitted model that plays noise, at the first recorded condition.
fn noise<'a>(
    request: &'a AssetRequest,
    conditions: &ConditionSpectra,
    fitted: &'a FittedModels,
) -> Option<SteadyVoice<'a>> {
    let is_recorded = |condition: usize| conditions.all[condition].condition.is_recorded();
    fitted.models.iter().find_map(|one| {
        let representation = &one.representation;
        let mut models = request.models.iter().map(|choice| &choice.model);
        let model = models.find(|model| model.id() == representation.model)?;
        let at = representation.at.iter().position(|at| is_recorded(at.condition))?;
        let band = conditions.all.first()?.spectrum.band;
        let voice = SteadyVoice { model, parameters: one.parameters.get(at)?, band };
        (!model.has_lines()).then_some(voice)
    })
}

fn assemble(
    request: &AssetRequest,
    of: ConditionSpectra,
    grid: Option<GridReport>,
    fitted: FittedModels,
) -> FittedAsset {
    let ConditionSpectra { all, contact, law, recordings } = of;
    let (conditions, spectra): (Vec<_>, Vec<TextureSpectrum>) =
        all.into_iter().map(|one| (one.condition, one.spectrum)).unzip();
    let mut warnings = recordings.warnings.into_notices();
    warnings.extend(fitted.warnings);
    let provenance = Provenance {
        tool: request.tool.clone(),
        simulated: recordings.simulated,
        recordings: recordings.sources,
        made: None,
        options: request.recorded_options.clone(),
        warnings: warnings.iter().map(Notice::to_string).collect(),
    };
    // All conditions have the same band and quantity.
    let band = spectra.first().map_or(Band::TACTILE, |s| s.band);
    let quantity = spectra.first().map_or(Quantity::default(), |s| s.quantity);
    let (mut models, mut felt, mut fit_ms) = (Vec::new(), Vec::new(), Vec::new());
    for one in fitted.models {
        models.push((one.representation, one.parameters));
        felt.push(one.felt);
        fit_ms.push(one.fit_ms);
    }
    let mut asset = new_asset(&request.name, quantity, band, provenance, conditions, models);
    let manifest = &mut asset.manifest;
    manifest.license.clone_from(&request.license);
    manifest.author.clone_from(&request.author);
    manifest.tags.clone_from(&request.tags);
    (manifest.contact, manifest.law) = (contact, Some(law));
    if request.keep_reference {
        let to_f32 = |s: &TextureSpectrum| s.magnitude.iter().map(|&m| m as f32).collect();
        manifest.reference = Some(Reference { file: "reference.bin".to_owned() });
        asset.reference = Some(spectra.iter().map(to_f32).collect());
    }
    FittedAsset {
        asset: request.coding.of(asset),
        fit_ms,
        skipped: fitted.skipped,
        spectra,
        felt,
        warnings,
        notes: recordings.notes.into_notices(),
        findings: recordings.findings,
        grid,
    }
}

/// Returns an asset with the given models. Each entry of `models` is a representation and its
/// parameters: one list of values for each of the representation's conditions. Optional keys of the
/// manifest, such as the licence and the law, are left out.
pub fn new_asset(
    name: &str,
    quantity: Quantity,
    band: Band,
    provenance: Provenance,
    conditions: Vec<Condition>,
    models: Vec<(Representation, Vec<Vec<f64>>)>,
) -> Asset {
    let (representations, parameters) = models.into_iter().unzip();
    let mut manifest = Manifest {
        htex: htex_format::VERSION.to_owned(),
        name: name.to_owned(),
        license: None,
        author: None,
        tags: Vec::new(),
        description: None,
        source: None,
        doi: None,
        sensor: None,
        finger: None,
        contact: Contact::Unknown,
        quantity,
        unit: quantity.unit().to_owned(),
        band,
        provenance,
        conditions,
        law: None,
        fluctuation: None,
        representations,
        reference: None,
        plugins: Vec::new(),
        extensions: BTreeMap::new(),
        extensions_required: Vec::new(),
        other: BTreeMap::new(),
    };
    manifest.htex = manifest.lowest_version();
    Asset { manifest, parameters, reference: None, plugins: Vec::new(), notes: Vec::new() }
}
