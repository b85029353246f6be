//! Fit options by name, as given by a user or a script.

use htex_model::FitOption;

use crate::{HostError, LoadedModel};

impl LoadedModel {
    /// Returns one value for each of the model's options. `given` contains pairs: the name of an
    /// option, and its value as text. For an option with named choices, this text is the name of a
    /// choice. Each option that is not in `given` gets its default value.
    ///
    /// # Errors
    /// Returns [`HostError::UnknownOption`] if the model has no option of a given name, or
    /// [`HostError::OptionValue`] with the allowed values if a value is not allowed.
    ///
    /// ```
    /// use htex_host::{HostError, Registry};
    /// let registry = Registry::builtin();
    /// let error = registry.find("bands")?.options(&[("colour", "red")]).unwrap_err();
    /// assert!(matches!(error, HostError::UnknownOption { .. }));
    /// # Ok::<(), HostError>(())
    /// ```
    pub fn options(&self, given: &[(&str, &str)]) -> Result<Vec<f64>, HostError> {
        let options = &self.descriptor().options;
        let mut values = self.descriptor().default_options();
        for (name, text) in given {
            let Some(i) = options.iter().position(|o| o.name == *name) else {
                let known: Vec<&str> = options.iter().map(|o| o.name.as_str()).collect();
                return Err(HostError::UnknownOption {
                    model: self.id().to_owned(),
                    name: (*name).to_owned(),
                    known: known.join(", "),
                });
            };
            values[i] = parse(&options[i], text).map_err(|takes| HostError::OptionValue {
                model: self.id().to_owned(),
                name: (*name).into(),
                text: (*text).into(),
                takes: takes.into(),
            })?;
        }
        Ok(values)
    }
}

/// Reads a value of an option.
///
/// # Errors
/// If the option does not allow the value, returns a text that says which values it allows.
fn parse(option: &FitOption, text: &str) -> Result<f64, String> {
    if !option.choices.is_empty() {
        let choice = option.choices.iter().position(|c| c == text);
        return choice
            .map(|i| i as f64)
            .ok_or_else(|| format!("one of {}", option.choices.join(", ")));
    }
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|v| (option.min..=option.max).contains(v))
        .filter(|v| !option.integer || v.fract() == 0.0)
        .ok_or_else(|| {
            let kind = if option.integer { "a whole number" } else { "a number" };
            let FitOption { min, max, unit, .. } = option;
            format!("{kind} from {min} to {max} {unit}")
        })
}
