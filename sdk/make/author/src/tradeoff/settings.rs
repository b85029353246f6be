//! The settings of a sweep, made by combining values of the models' fit options with values of the
//! options for playing.

use htex_host::{FitOption, LoadedModel};

use crate::AuthorError;
use crate::tradeoff::Setting;
use crate::tradeoff::knobs::{PLAYING, few, of_range};

/// The values of a knob, by its name.
type Knob = (String, Vec<String>);

/// Returns the settings of a model's fit options, the defaults first. A quick sweep varies only one
/// knob at a time.
pub(crate) fn fit_settings(model: &LoadedModel, quick: bool) -> Vec<Setting> {
    let mut settings = vec![Setting::default()];
    let mut add = |options: Vec<(String, String)>| {
        let options = without_defaults(model, options);
        let setting = Setting { options, ..Setting::default() };
        let given: Vec<(&str, &str)> =
            setting.options.iter().map(|(n, v)| (&n[..], &v[..])).collect();
        let takes = model.options(&given).is_ok();
        if takes && !is_idle(model, &setting) && !settings.contains(&setting) {
            settings.push(setting);
        }
    };
    let (together, mut alone) = knobs(model);
    if quick {
        alone = [together, alone].concat();
    } else {
        products(&together).into_iter().for_each(&mut add);
    }
    for (name, values) in alone {
        let values = if quick { few(&values) } else { values };
        values.into_iter().for_each(|value| add(vec![(name.clone(), value)]));
    }
    settings
}

/// Returns two lists: the knobs that are varied in all combinations, and the knobs that are varied
/// one at a time. If the model lists no values for an option, the option is varied over its whole
/// range.
fn knobs(model: &LoadedModel) -> (Vec<Knob>, Vec<Knob>) {
    let options = &model.descriptor().options;
    let listed = |values: fn(&FitOption) -> &[f64]| -> Vec<Knob> {
        let texts = |o: &FitOption| -> Vec<String> {
            values(o).iter().filter_map(|value| o.text(*value)).collect()
        };
        let knobs = options.iter().map(|o| (o.name.clone(), texts(o)));
        knobs.filter(|(_, values)| !values.is_empty()).collect()
    };
    let (together, alone) = (listed(|o| &o.sweep), listed(|o| &o.sweep_alone));
    if together.is_empty() && alone.is_empty() {
        let ranges = options.iter().map(|o| (o.name.clone(), of_range(o)));
        return (Vec::new(), ranges.collect());
    }
    (together, alone)
}

/// Returns the settings of [`PLAYING`].
///
/// # Errors
/// When the table of knobs has an invalid value.
pub(crate) fn playing_settings(quick: bool) -> Result<Vec<Setting>, AuthorError> {
    let mut settings = Vec::new();
    for (name, values) in PLAYING {
        let values = if quick { few(values) } else { values.to_vec() };
        for value in values {
            settings.push(Setting::default().playing(name, value)?);
        }
    }
    Ok(settings)
}

/// Returns all combinations of the knobs' values.
fn products(knobs: &[Knob]) -> Vec<Vec<(String, String)>> {
    if knobs.is_empty() {
        return Vec::new();
    }
    knobs.iter().fold(vec![Vec::new()], |all, (name, values)| {
        let with = |value: &String| {
            let pair = (name.clone(), value.clone());
            let one = move |options: &Vec<_>| [&options[..], std::slice::from_ref(&pair)].concat();
            all.iter().map(one).collect::<Vec<_>>()
        };
        values.iter().flat_map(with).collect()
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

/// Whether an option has no effect in this setting because its value exceeds the value of the
/// option that limits it ([`FitOption::not_above`]).
fn is_idle(model: &LoadedModel, setting: &Setting) -> bool {
    let options = &model.descriptor().options;
    let value = |name: &str| {
        let given = setting.options.iter().find(|(n, _)| n == name);
        let default = || options.iter().find(|o| o.name == name).map_or(f64::NAN, |o| o.default);
        given.and_then(|(_, v)| v.parse().ok()).unwrap_or_else(default)
    };
    options.iter().any(|o| o.not_above.as_ref().is_some_and(|high| value(&o.name) > value(high)))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
mod tests {
    use htex_host::Registry;

    use super::*;

    #[test]
    fn every_knob_of_a_model_turns_something() {
        let registry = Registry::builtin();
        for model in registry.models() {
            let options = &model.descriptor().options;
            let settings = fit_settings(model, false);
            for option in options {
                for value in option.sweep.iter().chain(&option.sweep_alone) {
                    let text = option.text(*value);
                    let text = text.unwrap_or_else(|| panic!("{} {value}", option.name));
                    let values = model.options(&[(&option.name, &text)]);
                    assert!(values.is_ok(), "{} {}={text}", model.short_name(), option.name);
                    let turned = |s: &Setting| s.options.iter().any(|(n, _)| *n == option.name);
                    assert!(settings.iter().any(turned), "{} {}", model.short_name(), option.name);
                }
            }
            assert_eq!(settings[0], Setting::default());
            assert!(options.is_empty() || fit_settings(model, true).len() < settings.len());
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
