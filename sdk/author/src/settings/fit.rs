//! Settings of fitting.

use std::collections::BTreeMap;

use htex_host::{HostError, LoadedModel, Origin, Registry};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ReadingSettings, SettingsError};
use crate::{AssetRequest, Grid, Level, ModelRequest};

/// Settings of fitting models; an absent one has its default.
///
/// ```
/// use htex_author::settings::{FitSettings, OptionSetting};
/// use htex_host::Registry;
///
/// let settings = FitSettings {
///     models: Some(vec!["ar".to_owned()]),
///     options: [("ar.order".to_owned(), OptionSetting::Number(6.0))].into(),
///     ..Default::default()
/// };
/// assert_eq!(settings.models(&Registry::builtin())?.len(), 1);
/// # Ok::<(), htex_author::settings::SettingsError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FitSettings {
    /// Models by short name or id, in the order of the representations; all when absent or when one is `all`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub models: Option<Vec<String>>,
    /// Fit options, `MODEL.NAME`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub options: BTreeMap<String, OptionSetting>,
    /// Level of the representations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<Level>,
    /// Whether to keep the recorded spectra in the asset.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keep_reference: Option<bool>,
    /// Grid of conditions that is fitted to recordings in which speed and force change freely: `auto`, or lines such as
    /// `speed=40,80,160` and `force=0.3,0.6` ([`Grid`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<Vec<String>>,
    /// Whether to refuse recordings with findings that are errors or warnings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strict: Option<bool>,
}

/// The value of a model's option: a number, or the name of a choice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum OptionSetting {
    /// A number.
    Number(f64),
    /// The name of a choice, or a number as text.
    Text(String),
}

impl std::fmt::Display for OptionSetting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Text(text) => text.fmt(f),
        }
    }
}

impl FitSettings {
    /// Returns these settings, and where they are absent those of `under`; options are laid over each other one by one.
    #[must_use]
    pub fn over(self, mut under: Self) -> Self {
        under.options.extend(self.options);
        Self {
            models: self.models.or(under.models),
            options: under.options,
            level: self.level.or(under.level),
            keep_reference: self.keep_reference.or(under.keep_reference),
            grid: self.grid.or(under.grid),
            strict: self.strict.or(under.strict),
        }
    }

    /// Adds options of the form `MODEL.NAME=VALUE`; a model may be named by its dotted id.
    ///
    /// # Errors
    /// When a text has another form.
    pub fn add_options(&mut self, texts: &[String]) -> Result<(), SettingsError> {
        for text in texts {
            let (name, value) = text
                .split_once('=')
                .filter(|(name, _)| name.contains('.'))
                .ok_or_else(|| SettingsError::OptionForm { text: text.clone() })?;
            let value = OptionSetting::Text(value.to_owned());
            self.options.insert(name.to_owned(), value);
        }
        Ok(())
    }

    /// Returns the models to fit, each with its options.
    ///
    /// # Errors
    /// When a model or an option is not known, or an option names a model that is not fitted.
    pub fn models(&self, registry: &Registry) -> Result<Vec<ModelRequest>, SettingsError> {
        let models = named_models(registry, self.models.as_deref().unwrap_or_default())?;
        let mut options = Vec::new();
        for (name, value) in &self.options {
            let (owner, option) = name.rsplit_once('.').ok_or_else(|| {
                let text = format!("{name}={value}");
                SettingsError::OptionForm { text }
            })?;
            if !models.iter().any(|model| is(model, owner)) {
                return Err(SettingsError::ModelNotFitted {
                    model: owner.to_owned(),
                    name: option.to_owned(),
                    fitted: models.iter().map(|m| m.short_name().to_owned()).collect(),
                });
            }
            options.push((owner, option, value.to_string()));
        }
        let request = |model: LoadedModel| {
            let own = options.iter().filter(|(owner, ..)| is(&model, owner));
            let own: Vec<(&str, &str)> = own.map(|(_, name, value)| (*name, &value[..])).collect();
            let options = model.options(&own)?;
            Ok(ModelRequest::new(&model).with_options(options))
        };
        models.into_iter().map(request).collect()
    }

    /// Returns the request of an asset that is fitted with these settings to recordings that are read with `reading`.
    ///
    /// # Errors
    /// As [`Self::models`], and when the setup's response cannot be read.
    pub fn request(
        &self,
        registry: &Registry,
        reading: &ReadingSettings,
        name: &str,
        tool: &str,
    ) -> Result<AssetRequest, SettingsError> {
        let mut recorded = reading.recorded();
        let options = self.options.iter();
        recorded.extend(options.map(|(name, value)| (name.clone(), value.to_string())));
        let level = self.level.unwrap_or_default();
        if level == Level::Fitted {
            recorded.insert("level".to_owned(), "fitted".to_owned());
        }
        let lines = self.grid.as_deref().unwrap_or_default();
        let grid = (!lines.is_empty()).then(|| Grid::parse(lines.iter().map(String::as_str)));
        if !lines.is_empty() {
            recorded.insert("grid".to_owned(), lines.join(" "));
        }
        // The models that come with this program: a plugin runs only where it is asked for.
        let builtin = registry.models().iter();
        let builtin = builtin.filter(|model| *model.origin() == Origin::Builtin);
        Ok(AssetRequest::new(name)
            .with_models(self.models(registry)?)
            .with_spectrum(reading.spectrum_options()?)
            .with_level(level)
            .with_alternatives(builtin.cloned().collect())
            .with_grid(
                grid.transpose()
                    .map_err(|error| SettingsError::Grid(Box::new(error)))?,
            )
            .with_strict(self.strict.unwrap_or_default())
            .with_keep_reference(self.keep_reference.unwrap_or_default())
            .with_recorded_options(recorded)
            .with_tool(tool))
    }
}

/// Returns the models of these names, each once. Without names, or when one of them is `all`, returns all; those that are
/// written in another language of the running program last.
///
/// # Errors
/// When a model is not known.
pub fn named_models(registry: &Registry, names: &[String]) -> Result<Vec<LoadedModel>, HostError> {
    if names.is_empty() || names.iter().any(|name| name == "all") {
        let mut all = registry.models().to_vec();
        all.sort_by_key(|model| matches!(model.origin(), Origin::Runtime(_)));
        return Ok(all);
    }
    let mut models: Vec<LoadedModel> = Vec::new();
    for name in names {
        let model = registry.find(name)?;
        if !models.iter().any(|m| m.id() == model.id()) {
            models.push(model.clone());
        }
    }
    Ok(models)
}

fn is(model: &LoadedModel, name: &str) -> bool {
    model.id() == name || model.short_name().eq_ignore_ascii_case(name)
}
