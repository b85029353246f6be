//! Search for a better fit when a representation has a large band error. The search tries other
//! options of the same model, and other models.

use htex_format::{Measure, Quality};
use htex_host::{FitOption, LoadedModel};

use crate::conditions::ConditionSpectrum;
use crate::fit::fit_spectrum;
use crate::level::Level;
use crate::measure::{agreement, read_spectrum};
use crate::request::ModelRequest;

/// Nine-band RMS error above which a warning is given, decibels.
const LIMIT_DB: f64 = 12.0;
/// Error of a single band (of the nine) above which a warning is given, decibels. The worst known
/// fit for which no better fit exists comes from `sbeta.error=magnitude` with bins beside the
/// peaks. This fit follows only the strongest bins. On a spectrum that falls steeply, its error is
/// 26 dB in the highest band and 10 dB RMS.
const BAND_LIMIT_DB: f64 = 24.0;

/// A fit that was tried, with its nine-band RMS error in decibels.
struct TrialFit {
    name: String,
    error_db: f64,
}

/// Returns a warning if a representation exceeds an error limit at one of its `measured`
/// conditions. To name better fits in the warning, the function tries other options of the model,
/// and each of `models` with its default options.
pub(crate) fn warning<'a>(
    choice: &ModelRequest,
    measured: &[(&Quality, &ConditionSpectrum)],
    models: impl Iterator<Item = &'a LoadedModel>,
    level: Level,
) -> Option<String> {
    let error_db = |quality: &Quality| quality.get(Measure::NineBand).unwrap_or(0.0);
    // A band with a large error is a fault even if the RMS is small because of the other bands.
    let excess = |quality: &Quality| {
        (error_db(quality) / LIMIT_DB).max(worst_band_db(quality) / BAND_LIMIT_DB)
    };
    let (quality, one) = *measured.iter().max_by(|a, b| excess(a.0).total_cmp(&excess(b.0)))?;
    let nine_band_db = error_db(quality);
    let worst_db = worst_band_db(quality);
    if nine_band_db <= LIMIT_DB && worst_db <= BAND_LIMIT_DB {
        return None;
    }
    let try_one = |model: &LoadedModel, options: Vec<f64>, name: String| {
        let error_db = error_of(model, &options, one, level)?;
        (error_db < nine_band_db).then_some(TrialFit { name, error_db })
    };
    let own = other_options(choice).into_iter();
    let best_option = best(own.filter_map(|(name, options)| try_one(&choice.model, options, name)));
    let mut tried = vec![choice.model.id()];
    let others = models.filter(|model| {
        let is_new = !tried.contains(&model.id());
        tried.push(model.id());
        is_new
    });
    let best_model = best(others.filter_map(|model| {
        let name = format!("the model {}", model.short_name());
        try_one(model, model.descriptor().default_options(), name)
    }));
    let better: Vec<String> = best_option
        .into_iter()
        .chain(best_model)
        .map(|tried| format!("{} with {:.1} dB", tried.name, tried.error_db))
        .collect();
    let advice = match &better[..] {
        [] => "no other option or model fits better".to_owned(),
        better => format!("better on this recording: {}", better.join(", ")),
    };
    let model = choice.model.short_name();
    Some(if nine_band_db > LIMIT_DB {
        format!("the nine-band error of {model} is {nine_band_db:.1} dB (RMS); {advice}")
    } else {
        format!(
            "the nine-band error of {model} is {worst_db:.1} dB in the worst band and {nine_band_db:.1} dB RMS; {advice}"
        )
    })
}

/// Largest absolute error of a band, decibels.
fn worst_band_db(quality: &Quality) -> f64 {
    let bands = quality.band_error_db.iter();
    bands.fold(0.0, |worst, error| worst.max(error.abs()))
}

fn best(tried: impl Iterator<Item = TrialFit>) -> Option<TrialFit> {
    tried.min_by(|a, b| a.error_db.total_cmp(&b.error_db))
}

/// Returns variants of the request's options, each named `model.option=value`. Each variant changes
/// only one option, to another choice of the option or to an end of its range.
fn other_options(choice: &ModelRequest) -> Vec<(String, Vec<f64>)> {
    let mut others = Vec::new();
    let model = &choice.model;
    for (i, option) in model.descriptor().options.iter().enumerate() {
        for value in other_values(option) {
            let mut options = choice.options.clone();
            // With this value, the fit would be the one that has the error.
            if options.get(i).is_none_or(|now| *now == value) {
                continue;
            }
            options[i] = value;
            let shown =
                option.choices.get(value as usize).cloned().unwrap_or_else(|| value.to_string());
            others.push((format!("{}.{}={shown}", model.short_name(), option.name), options));
        }
    }
    others
}

fn other_values(option: &FitOption) -> Vec<f64> {
    match option.choices.len() {
        0 => vec![option.min, option.max],
        choices => (0..choices).map(|choice| choice as f64).collect(),
    }
}

/// Returns the nine-band RMS error of a model's stored fit. The error is computed from the spectrum
/// that a recording of the played texture would have. `None` if the model cannot be fitted.
fn error_of(
    model: &LoadedModel,
    options: &[f64],
    one: &ConditionSpectrum,
    level: Level,
) -> Option<f64> {
    let reference = one.spectrum.as_ref();
    // The fit is compared in the form in which an asset stores it, because the other error was also
    // measured in this form.
    let fit = fit_spectrum(model, options, &one.spectrum, one.motion(), level).ok()?;
    let magnitude = read_spectrum(model, &fit.stored, fit.level_rms, reference).ok()?;
    let error = agreement(reference, &magnitude).get(Measure::NineBand);
    error.filter(|error| error.is_finite())
}
