//! Fitting: from recordings to a fitted and measured asset.

use std::collections::BTreeMap;

use htex_base::finding::Notice;
use htex_dsp::Band;
use htex_dsp::bands::{BAND_COUNT, BandBank, band_error_db, rms};
use htex_format::{
    Asset, AtCondition, Condition, Contact, Law, Manifest, Measure, Provenance, Quality, Quantity,
    Reference, Representation, round_within,
};
use htex_host::{HostError, Instant, LoadedModel, Origin};

use crate::alternatives::warning;
use crate::between;
use crate::conditions::{Group, group_takes};
use crate::felt::FeltError;
use crate::grid::{GridReport, LeftOutBlock, group_grid, left_out};
use crate::law::law;
use crate::level::{Level, stored_level};
use crate::recording_finding::RecordingFinding;
use crate::request::{AssetRequest, ModelRequest};
use crate::spectrum::SpectrumRef;
use crate::stored::stored_fields;
use crate::take::Take;
use crate::{AuthorError, TextureSpectrum, agreement, read_spectrum, rendered_spectrum};

/// A fitted asset, with results that its file does not store.
#[derive(Debug, Clone)]
pub struct FittedAsset {
    pub asset: Asset,
    /// Time taken by each representation's fits, milliseconds.
    pub fit_ms: Vec<f64>,
    /// Models that could not be fitted, with the reasons.
    pub skipped: Vec<(String, String)>,
    /// The texture spectrum of each condition.
    pub spectra: Vec<TextureSpectrum>,
    /// How much of the difference from these spectra can be felt, for each representation at each
    /// of its conditions. `None` at a condition that was computed between recorded ones, where
    /// there is no recording to compare with.
    pub felt: Vec<Vec<Option<FeltError>>>,
    /// The warnings in the asset's provenance, each with settings that help.
    pub warnings: Vec<Notice>,
    /// Findings of the recordings that are less severe than a warning: what was left out, and why.
    pub notes: Vec<Notice>,
    /// All findings of the recordings, recording by recording.
    pub findings: Vec<RecordingFinding>,
    /// The grid of conditions, if one was requested.
    pub grid: Option<GridReport>,
}

/// Fits every model at every condition, measures the parameters as they are stored, and returns the
/// asset.
///
/// A model that cannot be fitted is left out and listed in `skipped`.
///
/// # Errors
/// When a recording cannot be used, or no model could be fitted.
pub fn fit_asset(takes: &[Take], request: &AssetRequest) -> Result<FittedAsset, AuthorError> {
    fit_asset_watched(takes, request, &mut |_| {})
}

/// As [`fit_asset`], but calls `begins` with each model before it is fitted.
///
/// # Errors
/// As [`fit_asset`].
pub fn fit_asset_watched(
    takes: &[Take],
    request: &AssetRequest,
    begins: &mut dyn FnMut(&LoadedModel),
) -> Result<FittedAsset, AuthorError> {
    let contact = contact(takes);
    let (spectrum, strict) = (&request.spectrum, request.strict);
    let (mut grouped, grid, left_out) = match &request.grid {
        None => (group_takes(takes, spectrum, strict)?, None, Vec::new()),
        Some(grid) => {
            let gridded = group_grid(takes, grid, spectrum, strict, contact)?;
            (gridded.grouped, Some(gridded.report), gridded.left_out)
        }
    };
    let mut warnings = std::mem::take(&mut grouped.warnings);
    let notes = std::mem::take(&mut grouped.notes);
    let findings = std::mem::take(&mut grouped.findings);
    let law = {
        let spectra: Vec<&TextureSpectrum> = grouped.groups.iter().map(|g| &g.spectrum).collect();
        law(&grouped.conditions, &spectra, contact)
    };
    // A grid chooses its own speeds as close together as its recordings support.
    if grid.is_none() {
        between::add(&mut grouped, &law);
    }
    let mut fitted = Vec::new();
    let mut skipped = Vec::new();
    for choice in &request.models {
        begins(&choice.model);
        match fit_model(choice, &grouped.groups, request.level) {
            Ok(mut one) => {
                one.leave_out(choice, &left_out, request.level);
                let of_bands = band_error_warning(choice, &one, &grouped.groups, request);
                let told = of_bands.into_iter().chain(origin_warning(&choice.model));
                warnings.extend(told.map(Notice::from));
                fitted.push(one);
            }
            // Only a refusal by the model itself skips it. Every other error concerns the
            // recordings or the program.
            Err(AuthorError::Model(HostError::Call { call, message, .. })) => {
                let message = match call {
                    "fit" => message,
                    other => format!("{other}: {message}"),
                };
                warnings.push(format!("{} left out: {message}", choice.model.id()).into());
                skipped.push((choice.model.id().to_owned(), message));
            }
            Err(other) => return Err(other),
        }
    }
    if fitted.is_empty() {
        let reasons = skipped.iter().map(|(id, why)| format!("{id}: {why}"));
        return Err(AuthorError::NothingFitted { reasons: reasons.collect::<Vec<_>>().join("; ") });
    }
    let spectra: Vec<TextureSpectrum> = grouped.groups.into_iter().map(|g| g.spectrum).collect();
    let provenance = Provenance {
        tool: request.tool.clone(),
        simulated: takes.iter().any(|take| take.recording.simulated),
        recordings: grouped.sources,
        made: None,
        options: request.recorded_options.clone(),
        warnings: warnings.iter().map(Notice::to_string).collect(),
    };
    let fit_ms = fitted.iter().map(|f| f.fit_ms).collect();
    let felt = fitted.iter_mut().map(|f| std::mem::take(&mut f.felt)).collect();
    let asset = assemble(request, provenance, (contact, law), grouped.conditions, &spectra, fitted);
    Ok(FittedAsset { asset, fit_ms, skipped, spectra, felt, warnings, notes, findings, grid })
}

/// What slid over the surface, as far as the recordings show it: the simulator always uses a
/// finger.
fn contact(takes: &[Take]) -> Contact {
    if takes.iter().all(|take| take.recording.simulated) {
        Contact::Finger
    } else {
        Contact::Unknown
    }
}

struct FittedModel {
    representation: Representation,
    parameters: Vec<Vec<f64>>,
    felt: Vec<Option<FeltError>>,
    fit_ms: f64,
}

impl FittedModel {
    /// Adds the errors on blocks of time that were left out of the fit.
    fn leave_out(&mut self, choice: &ModelRequest, blocks: &[LeftOutBlock], level: Level) {
        let at = &mut self.representation.at;
        let fit = |group: &Group| {
            let fit = fit_group(choice, group, level)?;
            Ok((fit.stored, fit.level_rms))
        };
        let errors = left_out(&choice.model, at.len(), blocks, fit);
        for (at, error) in at.iter_mut().zip(errors) {
            at.left_out = error;
        }
    }
}

/// A model fitted at one condition.
struct GroupFit {
    fitted: Vec<f64>,
    /// The parameters as an asset stores them.
    stored: Vec<f64>,
    level_rms: f64,
    fit_ms: f64,
}

fn fit_group(choice: &ModelRequest, group: &Group, level: Level) -> Result<GroupFit, AuthorError> {
    let model = &choice.model;
    let start = Instant::now();
    let input = group.spectrum.fit_input(&choice.options, group.condition);
    let fit = model.fit(&input)?;
    let fit_ms = start.elapsed().as_secs_f64() * 1e3;
    let stored =
        round_within(&stored_fields(model.descriptor()), model.descriptor(), &fit.parameters)?;
    let level_rms = stored_level(model, &fit, &stored, group.spectrum.as_ref(), level)?;
    Ok(GroupFit { fitted: fit.parameters, stored, level_rms, fit_ms })
}

fn fit_model(
    choice: &ModelRequest,
    groups: &[Group],
    level: Level,
) -> Result<FittedModel, AuthorError> {
    let model = &choice.model;
    let fields = stored_fields(model.descriptor());
    let (mut at, mut parameters, mut felt, mut fit_ms) = (Vec::new(), Vec::new(), Vec::new(), 0.0);
    for (condition, group) in groups.iter().enumerate() {
        let reference = group.spectrum.as_ref();
        let GroupFit { fitted, stored, level_rms, fit_ms: own_ms } =
            fit_group(choice, group, level)?;
        fit_ms += own_ms;
        let (magnitude, measured) = read_and_measure(model, &stored, level_rms, reference)?;
        let rounding = rounding_error_db(model, &fitted, &stored, reference)?;
        // Nothing was recorded at a computed condition, so there is nothing to compare with.
        let quality = group
            .spectrum
            .is_recorded()
            .then_some(Quality { rounding_error_db: Some(rounding), ..measured });
        felt.push(quality.as_ref().map(|quality| {
            FeltError::new(&group.spectrum, &magnitude, quality.get(Measure::NineBand))
        }));
        at.push(AtCondition { condition, level_rms, quality, left_out: None });
        parameters.push(stored);
    }
    let representation = Representation {
        model: model.id().to_owned(),
        model_version: model.descriptor().version.clone(),
        fields,
        at,
        triangles: Vec::new(),
        parameters: format!("parameters/{}.bin", model.short_name()),
    };
    Ok(FittedModel { representation, parameters, felt, fit_ms })
}

/// Returns a warning if no other program can load the representation's model.
fn origin_warning(model: &LoadedModel) -> Option<String> {
    let Origin::Runtime(origin) = model.origin() else {
        return None;
    };
    Some(format!(
        "{} is a model of {origin}; it plays only in programs that register a model of this id",
        model.id()
    ))
}

/// Returns a warning if a representation has a large band error.
fn band_error_warning(
    choice: &ModelRequest,
    fitted: &FittedModel,
    groups: &[Group],
    request: &AssetRequest,
) -> Option<String> {
    let all = fitted.representation.at.iter().zip(groups);
    let measured = all.filter_map(|(at, group)| Some((at.quality.as_ref()?, group)));
    let measured: Vec<(&Quality, &Group)> = measured.collect();
    let mut models: Vec<LoadedModel> = request.models.iter().map(|m| m.model.clone()).collect();
    let known = |models: &[LoadedModel], id: &str| models.iter().any(|m| m.id() == id);
    for model in &request.alternatives {
        if !known(&models, model.id()) {
            models.push(model.clone());
        }
    }
    warning(choice, &measured, &models, request.level)
}

/// Measures how well parameters at a level agree with a recorded spectrum: by magnitude, as a
/// recording of the voice would read it, and by rendered samples.
///
/// # Errors
/// When the model refuses the parameters.
pub fn measure(
    model: &LoadedModel,
    parameters: &[f64],
    level_rms: f64,
    reference: SpectrumRef<'_>,
) -> Result<Quality, AuthorError> {
    Ok(read_and_measure(model, parameters, level_rms, reference)?.1)
}

/// As [`measure`], but also returns the magnitudes as a recording of the voice would read them
/// ([`read_spectrum`]).
pub(crate) fn read_and_measure(
    model: &LoadedModel,
    parameters: &[f64],
    level_rms: f64,
    reference: SpectrumRef<'_>,
) -> Result<(Vec<f64>, Quality), AuthorError> {
    let rendered = rendered_spectrum(model, parameters, level_rms, reference)?;
    let by_samples = agreement(reference, &rendered).measures;
    // Lines interfere with each other, so what a recording of them shows follows from their samples
    // and not from their magnitudes.
    let read = if model.has_lines() {
        rendered
    } else {
        read_spectrum(model, parameters, level_rms, reference)?
    };
    let of_both = Measure::of_both().filter(|m| m.row().stored);
    let quality = Quality {
        by_samples: by_samples.only(of_both),
        ..Quality::from(agreement(reference, &read))
    };
    Ok((read, quality))
}

/// Returns the nine-band RMS difference between the shapes of the fitted and the stored parameters,
/// decibels.
fn rounding_error_db(
    model: &LoadedModel,
    fitted: &[f64],
    stored: &[f64],
    reference: SpectrumRef<'_>,
) -> Result<f64, AuthorError> {
    let bank = BandBank::new(BAND_COUNT, reference.band, reference.frequency_hz);
    let energies = |parameters: &[f64]| {
        let shape = model.magnitude(parameters, reference.band, reference.frequency_hz)?;
        Ok::<_, HostError>(bank.energies(&shape))
    };
    Ok(rms(&band_error_db(&energies(fitted)?, &energies(stored)?)))
}

fn assemble(
    request: &AssetRequest,
    provenance: Provenance,
    (contact, law): (Contact, Law),
    conditions: Vec<Condition>,
    spectra: &[TextureSpectrum],
    fitted: Vec<FittedModel>,
) -> Asset {
    // `group_takes` returns one spectrum per condition, all with the same band and quantity.
    let band = spectra.first().map_or(Band::TACTILE, |s| s.band);
    let quantity = spectra.first().map_or(Quantity::default(), |s| s.quantity);
    let (representations, parameters) =
        fitted.into_iter().map(|f| (f.representation, f.parameters)).unzip();
    let to_f32 = |s: &TextureSpectrum| s.magnitude.iter().map(|&m| m as f32).collect();
    Asset {
        manifest: Manifest {
            htex: htex_format::VERSION.to_owned(),
            name: request.name.clone(),
            license: request.license.clone(),
            author: request.author.clone(),
            tags: request.tags.clone(),
            description: None,
            source: None,
            doi: None,
            sensor: None,
            finger: None,
            contact,
            quantity,
            unit: quantity.unit().to_owned(),
            band,
            provenance,
            conditions,
            law: Some(law),
            representations,
            reference: request
                .keep_reference
                .then(|| Reference { file: "reference.bin".to_owned() }),
            plugins: Vec::new(),
            extensions: BTreeMap::new(),
            extensions_required: Vec::new(),
            other: BTreeMap::new(),
        },
        parameters,
        reference: request.keep_reference.then(|| spectra.iter().map(to_f32).collect()),
        plugins: Vec::new(),
        notes: Vec::new(),
    }
}
