//! Fit options by name, as given by a user or a script.

use htex_model::FitOption;

use crate::{HostError, LoadedModel, OptionError};

impl LoadedModel {
    /// Returns one value for each of the model's options. `given` contains pairs of an option's
    /// name and its value as text; the text of a choice is its name. An option that is not in
    /// `given` has its default.
    ///
    /// # Errors
    /// [`HostError::Option`] if an option is unknown or its value is not allowed.
    pub fn options(&self, given: &[(&str, &str)]) -> Result<Vec<f64>, HostError> {
        let in_model =
            |error| HostError::Option { model: self.id().to_owned(), error: Box::new(error) };
        let options = &self.descriptor().options;
        let mut values = self.descriptor().default_options();
        for (name, text) in given {
            let Some(i) = options.iter().position(|o| o.name == *name) else {
                let known: Vec<&str> = options.iter().map(|o| o.name.as_str()).collect();
                return Err(in_model(OptionError::Unknown {
                    name: (*name).to_owned(),
                    known: known.join(", "),
                }));
            };
            values[i] = parse(&options[i], text).map_err(in_model)?;
        }
        Ok(values)
    }
}

fn parse(option: &FitOption, text: &str) -> Result<f64, OptionError> {
    let wrong =
        |takes| OptionError::Value { name: option.name.clone(), text: text.to_owned(), takes };
    if !option.choices.is_empty() {
        let choice = option.choices.iter().position(|c| c == text);
        return choice
            .map(|i| i as f64)
            .ok_or_else(|| wrong(format!("one of {}", option.choices.join(", "))));
    }
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|v| (option.min..=option.max).contains(v))
        .filter(|v| !option.integer || v.fract() == 0.0)
        .ok_or_else(|| {
            let kind = if option.integer { "a whole number" } else { "a number" };
            let FitOption { min, max, unit, .. } = option;
            wrong(format!("{kind} from {min} to {max} {unit}"))
        })
}
