//! The third stage of a fit. For each model and condition, this stage fits the parameters and
//! rounds them to the values that the file can store. The stage then computes a level for the
//! rounded parameters, and measures how well the rounded parameters agree with the recording.

use htex_base::finding::Notice;
use htex_format::{
    AtCondition, LeftOut, Measure, Quality, Representation, Steps, StoredAs, StoredField,
    round_within, stored_unit,
};
use htex_host::{
    Descriptor, Field, FitCondition, HostError, Instant, Kind, LoadedModel, Origin, Store,
};

use crate::alternatives::warning;
use crate::conditions::ConditionSpectrum;
use crate::felt::FeltError;
use crate::grid::{LeftOutBlock, left_out, left_out_rms};
use crate::level::{Level, stored_level};
use crate::measure::{agreement, measure, read_spectrum, rounding_error_db};
use crate::request::ModelRequest;
use crate::{AuthorError, TextureSpectrum};

/// The models of an asset, fitted at all conditions.
#[derive(Default)]
pub(crate) struct FittedModels {
    pub(crate) models: Vec<FittedModel>,
    /// Models that could not be fitted, with the reasons.
    pub(crate) skipped: Vec<(String, String)>,
    pub(crate) warnings: Vec<Notice>,
}

/// A model fitted at all conditions.
pub(crate) struct FittedModel {
    pub(crate) representation: Representation,
    pub(crate) parameters: Vec<Vec<f64>>,
    pub(crate) felt: Vec<Option<FeltError>>,
    /// Time that the fits took, milliseconds.
    pub(crate) fit_ms: f64,
}

/// Fits models at all conditions. `blocks` are the blocks of time that a grid leaves out. They are
/// needed for held-out errors. If a model has a large error, `alternatives` are tried. `begins` is
/// called with each model before it is fitted.
///
/// # Errors
/// Returns an error if no model could be fitted, or if a fit fails and the reason is not that the
/// model refused the spectrum.
pub(crate) fn fit_models(
    choices: &[ModelRequest],
    all: &[ConditionSpectrum],
    blocks: &[LeftOutBlock],
    level: Level,
    alternatives: &[LoadedModel],
    begins: &mut dyn FnMut(&LoadedModel),
) -> Result<FittedModels, AuthorError> {
    let mut fitted = FittedModels::default();
    for choice in choices {
        begins(&choice.model);
        match fit_model(choice, all, blocks, level) {
            Ok(one) => {
                let tried = choices.iter().map(|choice| &choice.model).chain(alternatives);
                let measured = one.representation.at.iter().zip(all);
                let measured = measured.filter_map(|(at, one)| Some((at.quality.as_ref()?, one)));
                let of_bands = warning(choice, &measured.collect::<Vec<_>>(), tried, level);
                let both = of_bands.into_iter().chain(origin_warning(&choice.model));
                fitted.warnings.extend(both.map(Notice::from));
                fitted.models.push(one);
            }
            // A model is skipped only if the model itself refuses the spectrum. Every other error
            // concerns the recordings or the program.
            Err(AuthorError::Model(HostError::Call { call, message, .. })) => {
                let message = match call {
                    "fit" => message,
                    other => format!("{other}: {message}"),
                };
                let id = choice.model.id();
                fitted.warnings.push(format!("{id} left out: {message}").into());
                fitted.skipped.push((id.to_owned(), message));
            }
            Err(other) => return Err(other),
        }
    }
    if fitted.models.is_empty() {
        let reasons = fitted.skipped.iter().map(|(id, why)| format!("{id}: {why}"));
        return Err(AuthorError::NothingFitted { reasons: reasons.collect::<Vec<_>>().join("; ") });
    }
    Ok(fitted)
}

/// A model fitted at one condition.
pub(crate) struct ConditionFit {
    pub(crate) fitted: Vec<f64>,
    /// The parameters as an asset stores them.
    pub(crate) stored: Vec<f64>,
    pub(crate) level_rms: f64,
    pub(crate) fit_ms: f64,
}

/// Fits a model with these options to a spectrum at a motion.
pub(crate) fn fit_spectrum(
    model: &LoadedModel,
    options: &[f64],
    spectrum: &TextureSpectrum,
    motion: FitCondition,
    level: Level,
) -> Result<ConditionFit, AuthorError> {
    let start = Instant::now();
    let fit = model.fit(&spectrum.fit_input(options, motion))?;
    let fit_ms = start.elapsed().as_secs_f64() * 1e3;
    let stored =
        round_within(&stored_fields(model.descriptor()), model.descriptor(), &fit.parameters)?;
    let level_rms = stored_level(model, &fit, &stored, spectrum.as_ref(), level)?;
    Ok(ConditionFit { fitted: fit.parameters, stored, level_rms, fit_ms })
}

/// Returns the held-out error of a model at one condition: the model is fitted to the odd blocks of
/// time and compared with the even blocks. Returns `None` if there are too few blocks, or if the
/// model cannot be fitted to the odd blocks.
fn left_out_half(
    model: &LoadedModel,
    options: &[f64],
    one: &ConditionSpectrum,
    level: Level,
) -> Option<LeftOut> {
    let [odd, even] = one.halves.as_ref()?;
    let fit = fit_spectrum(model, options, odd, one.motion(), level).ok()?;
    let magnitude = read_spectrum(model, &fit.stored, fit.level_rms, even.as_ref()).ok()?;
    left_out_rms(&[agreement(even.as_ref(), &magnitude).measures])
}

fn fit_model(
    choice: &ModelRequest,
    all: &[ConditionSpectrum],
    blocks: &[LeftOutBlock],
    level: Level,
) -> Result<FittedModel, AuthorError> {
    let model = &choice.model;
    let (mut at, mut parameters, mut felt, mut fit_ms) = (Vec::new(), Vec::new(), Vec::new(), 0.0);
    let fit_at = |one: &ConditionSpectrum| {
        fit_spectrum(model, &choice.options, &one.spectrum, one.motion(), level)
    };
    for (condition, one) in all.iter().enumerate() {
        // A model that follows the motion can itself play other speeds. It cannot be fitted to a
        // spectrum that was computed and not recorded.
        if model.follows_motion() && !one.spectrum.is_recorded() {
            continue;
        }
        let reference = one.spectrum.as_ref();
        let fit = fit_at(one)?;
        let (magnitude, measured) = measure(model, &fit.stored, fit.level_rms, reference)?;
        let rounding = rounding_error_db(model, &fit.fitted, &fit.stored, reference)?;
        // Nothing was recorded at a computed condition, so there is nothing to compare with.
        let quality = one
            .spectrum
            .is_recorded()
            .then_some(Quality { rounding_error_db: Some(rounding), ..measured });
        felt.push(quality.as_ref().map(|quality| {
            FeltError::new(&one.spectrum, &magnitude, quality.get(Measure::NineBand))
        }));
        let left_out = left_out_half(model, &choice.options, one, level);
        at.push(AtCondition { condition, level_rms: fit.level_rms, quality, left_out });
        parameters.push(fit.stored);
        fit_ms += fit.fit_ms;
    }
    for (at, error) in at.iter_mut().zip(left_out(model, all.len(), blocks, fit_at)) {
        at.left_out = at.left_out.or(error);
    }
    let representation = representation(model, at);
    Ok(FittedModel { representation, parameters, felt, fit_ms })
}

/// Returns a model's representation, with its level and quality at each condition in `at`. The
/// parameters are stored in `parameters/NAME.bin`, where NAME is the model's short name.
pub fn representation(model: &LoadedModel, at: Vec<AtCondition>) -> Representation {
    Representation {
        model: model.id().to_owned(),
        model_version: model.descriptor().version.clone(),
        fields: stored_fields(model.descriptor()),
        at,
        triangles: Vec::new(),
        parameters: format!("parameters/{}.bin", model.short_name()),
    }
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

/// Returns the descriptions of a model's parameters, as an asset stores them.
pub fn stored_fields(descriptor: &Descriptor) -> Vec<StoredField> {
    let field = |f: &Field| StoredField {
        name: f.name.clone(),
        unit: stored_unit(&f.unit).to_owned(),
        list: matches!(f.kind, Kind::List { .. }),
        store: store(f.store),
    };
    descriptor.fields.iter().map(field).collect()
}

fn store(store: Store) -> StoredAs {
    let steps = |scale, offset, log| Steps { scale, offset, log };
    match store {
        Store::F64 => StoredAs::F64,
        Store::F32 => StoredAs::F32,
        Store::U16 { scale, offset, log } => StoredAs::U16(steps(scale, offset, log)),
        Store::U8 { scale, offset, log } => StoredAs::U8(steps(scale, offset, log)),
        Store::Packed { scale, offset, log } => StoredAs::Packed(steps(scale, offset, log)),
    }
}
