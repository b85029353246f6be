//! Fit options by name, as a person or a script gives them.

use htex_model::FitOption;

use crate::{HostError, LoadedModel};

impl LoadedModel {
    /// One value for each of the model's options: those given as `(name, text)`, else the default.
    /// A choice is given by its name.
    ///
    /// # Errors
    /// [`HostError::Option`] with what is allowed.
    pub fn options(&self, given: &[(&str, &str)]) -> Result<Vec<f64>, HostError> {
        let error = |what| HostError::Option {
            model: self.id().to_owned(),
            what,
        };
        let options = &self.descriptor().options;
        let mut values = self.descriptor().default_options();
        for (name, text) in given {
            let Some(i) = options.iter().position(|o| o.name == *name) else {
                let known: Vec<&str> = options.iter().map(|o| o.name.as_str()).collect();
                return Err(error(format!(
                    "`{name}` is unknown; there are {}",
                    known.join(", ")
                )));
            };
            values[i] = parse(&options[i], text).map_err(error)?;
        }
        Ok(values)
    }
}

fn parse(option: &FitOption, text: &str) -> Result<f64, String> {
    if !option.choices.is_empty() {
        let choice = option.choices.iter().position(|c| c == text);
        return choice.map(|i| i as f64).ok_or_else(|| {
            let choices = option.choices.join(", ");
            format!("`{}` is `{text}`; it takes one of {choices}", option.name)
        });
    }
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|v| (option.min..=option.max).contains(v))
        .filter(|v| !option.integer || v.fract() == 0.0)
        .ok_or_else(|| {
            let kind = if option.integer {
                "a whole number"
            } else {
                "a number"
            };
            format!(
                "`{}` is `{text}`; it takes {kind} from {} to {} {}",
                option.name, option.min, option.max, option.unit
            )
        })
}
