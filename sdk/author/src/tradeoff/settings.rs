//! The settings of a sweep, made from the knobs of models and of playing.

use htex_host::{Knob, Knobs, LoadedModel, Registry};

use crate::AuthorError;
use crate::tradeoff::Setting;
use crate::tradeoff::knobs::{PLAYING, few, of_range};

/// Returns the settings of a model's fit options, the defaults first. A quick sweep varies only one
/// knob at a time.
pub(crate) fn fit_settings(model: &LoadedModel, quick: bool) -> Vec<Setting> {
    let mut settings = vec![Setting::default()];
    let knobs = knobs(model);
    let mut add = |options: Vec<(String, String)>| {
        let options = without_defaults(model, options);
        let setting = Setting { options, ..Setting::default() };
        // A plugin with the same name as a built-in model may lack some of these options.
        let given: Vec<(&str, &str)> =
            setting.options.iter().map(|(n, v)| (&n[..], &v[..])).collect();
        let takes = model.options(&given).is_ok();
        let idle = knobs.is_some_and(|knobs| is_idle(model, knobs, &setting));
        if takes && !idle && !settings.contains(&setting) {
            settings.push(setting);
        }
    };
    if let Some(knobs) = knobs.filter(|_| !quick) {
        products(knobs.together).into_iter().for_each(&mut add);
    }
    for (name, values) in alone(model, knobs, quick) {
        let values = if quick { few(&values) } else { values };
        values.into_iter().for_each(|value| add(vec![(name.clone(), value)]));
    }
    settings
}

/// The knobs of the built-in model with the same name. Thus a model that is loaded in another way,
/// or that replaces the built-in one, is swept in the same way.
fn knobs(model: &LoadedModel) -> Option<&'static Knobs> {
    Registry::builtin().find(model.short_name()).ok()?.knobs()
}

/// Names and values of the knobs that are varied one at a time.
fn alone(model: &LoadedModel, knobs: Option<&Knobs>, quick: bool) -> Vec<(String, Vec<String>)> {
    let Some(knobs) = knobs else {
        let options = model.descriptor().options.iter();
        return options.map(|o| (o.name.clone(), of_range(o))).collect();
    };
    let together = if quick { knobs.together } else { &[] };
    let owned = |knob: &Knob| {
        let values = knob.values.iter().map(|&value| value.to_owned());
        (knob.name.to_owned(), values.collect())
    };
    together.iter().chain(knobs.alone).map(owned).collect()
}

/// Returns the settings of [`PLAYING`].
///
/// # Errors
/// When the table of knobs has an invalid value.
pub(crate) fn playing_settings(quick: bool) -> Result<Vec<Setting>, AuthorError> {
    let mut settings = Vec::new();
    for knob in PLAYING {
        let values = if quick { few(knob.values) } else { knob.values.to_vec() };
        for value in values {
            settings.push(Setting::default().playing(knob.name, value)?);
        }
    }
    Ok(settings)
}

/// Returns all combinations of the knobs' values.
fn products(knobs: &[Knob]) -> Vec<Vec<(String, String)>> {
    knobs.iter().fold(vec![Vec::new()], |all, knob| {
        let with = |value: &'static str| {
            let pair = (knob.name.to_owned(), value.to_owned());
            let one = move |options: &Vec<_>| [&options[..], std::slice::from_ref(&pair)].concat();
            all.iter().map(one).collect::<Vec<_>>()
        };
        knob.values.iter().copied().flat_map(with).collect()
    })
}

/// Removes values that are the model's defaults.
fn without_defaults(
    model: &LoadedModel,
    mut options: Vec<(String, String)>,
) -> Vec<(String, String)> {
    let defaults = &model.descriptor().default_options();
    options.retain(|(name, value)| {
        let index = model.descriptor().options.iter().position(|o| o.name == *name);
        let chosen = model.options(&[(name, value)]).ok();
        index.zip(chosen).is_none_or(|(i, values)| values[i] != defaults[i])
    });
    options
}

/// Whether a knob has no effect in this setting because its value is above another knob's.
fn is_idle(model: &LoadedModel, knobs: &Knobs, setting: &Setting) -> bool {
    let value = |name: &str| {
        let given = setting.options.iter().find(|(n, _)| n == name);
        let default = || {
            let option = model.descriptor().options.iter().find(|o| o.name == name);
            option.map_or(f64::NAN, |o| o.default)
        };
        given.and_then(|(_, v)| v.parse().ok()).unwrap_or_else(default)
    };
    knobs.not_above.is_some_and(|(low, high)| value(low) > value(high))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
mod tests {
    use super::*;

    #[test]
    fn every_knob_of_a_model_turns_something() {
        let registry = Registry::builtin();
        for model in registry.models() {
            let Some(knobs) = model.knobs() else {
                continue;
            };
            let settings = fit_settings(model, false);
            for knob in knobs.together.iter().chain(knobs.alone) {
                for value in knob.values {
                    let values = model.options(&[(knob.name, value)]);
                    assert!(values.is_ok(), "{} {}={value}", model.short_name(), knob.name);
                }
                let turned = |s: &Setting| s.options.iter().any(|(name, _)| name == knob.name);
                assert!(settings.iter().any(turned), "{} {}", model.short_name(), knob.name);
            }
            assert_eq!(settings[0], Setting::default());
            assert!(fit_settings(model, true).len() < settings.len());
        }
        assert_eq!(playing_settings(false).unwrap().len(), 17);
    }

    #[test]
    fn the_values_of_a_model_without_knobs_span_its_ranges() {
        for model in Registry::builtin().models() {
            for option in &model.descriptor().options {
                let values = of_range(option);
                for value in &values {
                    model.options(&[(&option.name, value)]).unwrap();
                }
                let ends = [values.first(), values.last()].map(|end| end.unwrap().parse::<f64>());
                if let [Ok(first), Ok(last)] = ends {
                    assert_eq!((first, last), (option.min, option.max), "{}", option.name);
                }
            }
        }
    }

    #[test]
    fn a_cepstrum_has_no_more_terms_than_bands() {
        let registry = Registry::builtin();
        let settings = fit_settings(registry.find("mfcc").unwrap(), false);
        let words: Vec<String> = settings.iter().map(Setting::words).collect();
        assert!(words.contains(&"coefficients=40 bands=40".to_owned()), "{words:?}");
        assert!(!words.contains(&"coefficients=40".to_owned()));
    }
}
