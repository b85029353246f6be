//! Settings of fitting.

use std::collections::BTreeMap;

use htex_host::{HostError, LoadedModel, Origin, Registry};
use serde::{Deserialize, Deserializer, Serialize};

#[cfg(feature = "schemars")]
use super::OneOrMore;
use super::setting::settings;
use super::{Preset, ReadingSettings, one_or_more};
use crate::{AssetRequest, AuthorError, Coding, Grid, Level, ModelRequest};

settings! {
    /// Settings for fitting models. A missing setting has its default.
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
    /// # Ok::<(), htex_author::AuthorError>(())
    /// ```
    pub struct FitSettings {
        /// Models to fit, by short name or id, in the order of the representations. If missing, the
        /// default models are fitted.
        #[cfg_attr(feature = "clap", arg(
            long = "model",
            value_delimiter = ',',
            value_name = "ID,…",
            help = "Models to fit, by short name or id, comma-separated. `all` selects the models \
                    that htex fits by default; some models are fitted only if you name them \
                    [default: all]"
        ))]
        pub models: Option<Vec<String>>,

        /// Fit options, named `MODEL.NAME`. In a recipe, the options of a model can also be given
        /// as a table.
        #[serde(deserialize_with = "options")]
        #[cfg_attr(feature = "schemars", schemars(
            with = "BTreeMap<String, BTreeMap<String, OptionSetting>>",
            description = "Fit options: `options.ar.order = 6`.",
            extend("default" = {})
        ))]
        #[cfg_attr(feature = "clap", arg(skip))]
        pub options: BTreeMap<String, OptionSetting>,

        /// Several settings under one name. `paper` fits the paper's five models with the paper's
        /// choices. Other settings take precedence.
        #[cfg_attr(feature = "clap", arg(
            value_enum,
            value_name = "NAME",
            display_order = 1,
            help = "Several settings at once. `paper`: the paper's five models, sweeps, averaged \
                    magnitudes, and the paper's choice for every option (docs/paper.md). Other \
                    flags take precedence"
        ))]
        pub preset: Option<Preset> = "as",

        /// Where the level of the representations comes from.
        #[cfg_attr(feature = "clap", arg(
            value_enum,
            display_order = 2,
            help = "How strong a model plays. `recording`: as strong as the recording (its RMS in \
                    the frequency band). `fitted`: as strong as the model's own fit. Bands always \
                    plays at the level of its fit, because it stores energies [default: recording]"
        ))]
        pub level: Option<Level> = "level",

        /// Whether to keep the recorded spectra in the asset.
        #[cfg_attr(feature = "clap", arg(
            long = "keep-reference",
            action = clap::ArgAction::SetTrue,
            display_order = 4,
            help = "Keep the recorded spectra in the asset. Each condition takes 788 bytes before \
                    compression"
        ))]
        pub keep_reference: Option<bool>,

        /// Whether to store the asset in coded form, which takes fewer bytes but is refused by
        /// readers of version 1.0 of the format.
        #[cfg_attr(feature = "clap", arg(
            value_enum,
            display_order = 6,
            help = "Whether to code the asset: the same texture in fewer bytes, which readers of \
                    version 1.0 of the format refuse. `auto`: only with more than eight \
                    conditions, and only if the file becomes smaller [default: auto]"
        ))]
        pub storage: Option<Coding> = "storage",

        /// Whether to fit only the recorded conditions, without conditions computed from them.
        #[cfg_attr(feature = "clap", arg(
            long = "recorded-only",
            action = clap::ArgAction::SetTrue,
            display_order = 5,
            help = "Fit only the recorded conditions. Without this flag, htex adds computed \
                    conditions: between recorded speeds, if frequencies follow the speed; and at \
                    a third and three times the speed, if it is the only one and --contact is unknown"
        ))]
        pub recorded_only: Option<bool>,

        /// Grid of conditions for recordings in which speed and force change freely: `auto`, or
        /// lines such as `speed=40,80,160` and `force=0.3,0.6`.
        #[serde(deserialize_with = "one_or_more")]
        #[cfg_attr(feature = "schemars", schemars(with = "OneOrMore"))]
        #[cfg_attr(feature = "clap", arg(
            value_name = "LINES",
            display_order = 7,
            help = "Fit a grid of conditions to recordings in which speed and force change freely. \
                    With `auto`, htex chooses the speeds and forces. To choose them yourself, give \
                    --grid twice, e.g. --grid speed=40,80,160 --grid force=0.3,0.6"
        ))]
        pub grid: Option<Vec<String>> = "grid",

        /// Whether to refuse recordings with findings that are errors or warnings. In a recipe,
        /// this setting is one of the gates (requirements that an asset must meet). On the command
        /// line, the flag `--strict` belongs to the options for reading recordings.
        #[cfg_attr(feature = "schemars", schemars(skip))]
        #[cfg_attr(feature = "clap", arg(skip))]
        pub strict: Option<bool>,
    }
}

/// The value of a model's option: a number, or the name of a choice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum OptionSetting {
    /// A number.
    Number(f64),
    /// The name of a choice, or a number as text.
    Text(String),
}

/// Reads options given as `MODEL.NAME`, or as a table of options for each model.
fn options<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<BTreeMap<String, OptionSetting>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Options {
        One(OptionSetting),
        OfModel(BTreeMap<String, OptionSetting>),
    }
    let mut options = BTreeMap::new();
    for (name, own) in BTreeMap::<String, Options>::deserialize(deserializer)? {
        match own {
            Options::One(value) => options.extend([(name, value)]),
            Options::OfModel(own) => {
                let named = own.into_iter();
                options.extend(named.map(|(option, value)| (format!("{name}.{option}"), value)));
            }
        }
    }
    Ok(options)
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
    /// Adds options of the form `MODEL.NAME=VALUE`. `MODEL` may also be a model's dotted id.
    ///
    /// # Errors
    /// Returns an error if a text has another form.
    pub fn add_options(&mut self, texts: &[String]) -> Result<(), AuthorError> {
        for text in texts {
            let (name, value) = text
                .split_once('=')
                .filter(|(name, _)| name.contains('.'))
                .ok_or_else(|| AuthorError::OptionForm { text: text.clone() })?;
            let value = OptionSetting::Text(value.to_owned());
            self.options.insert(name.to_owned(), value);
        }
        Ok(())
    }

    /// Returns the models to fit, each with its options.
    ///
    /// # Errors
    /// Returns an error if a model or an option is unknown, or an option names a model that is not
    /// being fitted.
    pub fn models(&self, registry: &Registry) -> Result<Vec<ModelRequest>, AuthorError> {
        let models = self.named_models(registry)?;
        let mut options: Vec<(&str, &str, String)> = self.preset_options(&models).collect();
        for (name, value) in &self.options {
            // A model's id contains dots, so the option is the part after the last dot.
            let (owner, option) = name.rsplit_once('.').ok_or_else(|| {
                let text = format!("{name}={value}");
                AuthorError::OptionForm { text }
            })?;
            if !models.iter().any(|model| is(model, owner)) {
                return Err(AuthorError::ModelNotFitted {
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

    /// Returns the models to fit: the named ones, or else the models of the preset.
    fn named_models(&self, registry: &Registry) -> Result<Vec<LoadedModel>, HostError> {
        let named = self.models.as_deref().unwrap_or_default();
        match self.preset {
            Some(preset) if named.is_empty() => {
                let names: Vec<String> =
                    preset.models().iter().map(|name| (*name).to_owned()).collect();
                named_models(registry, &names)
            }
            _ => named_models(registry, named),
        }
    }

    /// Returns the preset's options for these models, except the options that the user has given:
    /// model, name and value.
    fn preset_options(
        &self,
        models: &[LoadedModel],
    ) -> impl Iterator<Item = (&'static str, &'static str, String)> {
        let of_preset = self.preset.map_or(&[][..], Preset::options).iter();
        let is_taken = move |owner: &str, option: &str| {
            let Some(model) = models.iter().find(|model| is(model, owner)) else { return false };
            let given = self.options.keys().filter_map(|name| name.rsplit_once('.'));
            !given.into_iter().any(|(of, name)| name == option && is(model, of))
        };
        let taken = of_preset.filter(move |(owner, option, _)| is_taken(owner, option));
        taken.map(|(owner, option, value)| (*owner, *option, (*value).to_owned()))
    }

    /// Returns settings for reading, completed by the preset.
    fn reading(&self, reading: &ReadingSettings) -> ReadingSettings {
        let Some(preset) = self.preset else { return reading.clone() };
        ReadingSettings {
            segments: reading.segments.or(Some(preset.segments())),
            averaging: reading.averaging.or(Some(preset.averaging())),
            ..reading.clone()
        }
    }

    /// Returns the reasons why models that the user named could not be fitted. `skipped` lists all
    /// models that were left out of an asset
    /// ([`FittedAsset::skipped`](crate::FittedAsset::skipped)). Models that the user did not name
    /// are not included, because they may be left out without a report.
    pub fn named_of(&self, skipped: &[(String, String)]) -> Vec<String> {
        let names = || self.models.iter().flatten();
        let is_named = |id: &str| {
            let short = id.rsplit('.').next().unwrap_or(id);
            names().any(|name| name == id || name.eq_ignore_ascii_case(short))
        };
        let named = skipped.iter().filter(|(id, _)| is_named(id));
        named.map(|(id, reason)| format!("{id}: {reason}")).collect()
    }

    /// Returns the request for an asset. The asset is fitted with these settings to recordings that
    /// are read with `reading`.
    ///
    /// # Errors
    /// Returns the errors of [`Self::models`], and an error if the setup's response or the grid
    /// cannot be read.
    pub fn request(
        &self,
        registry: &Registry,
        reading: &ReadingSettings,
        name: &str,
        tool: &str,
    ) -> Result<AssetRequest, AuthorError> {
        let reading = &self.reading(reading);
        let models = self.models(registry)?;
        let level = self.level.or(self.preset.map(Preset::level)).unwrap_or_default();
        let mut recorded = reading.recorded();
        let fitted: Vec<LoadedModel> = models.iter().map(|one| one.model.clone()).collect();
        for (owner, option, value) in self.preset_options(&fitted) {
            recorded.insert(format!("{owner}.{option}"), value);
        }
        let options = self.options.iter();
        recorded.extend(options.map(|(name, value)| (name.clone(), value.to_string())));
        recorded.extend(FitSettings { level: Some(level), ..self.clone() }.recorded());
        let lines = self.grid.as_deref().unwrap_or_default();
        let grid = (!lines.is_empty()).then(|| Grid::parse(lines.iter().map(String::as_str)));
        // Uses only the models that come with this program, because a plugin runs only if it is
        // requested.
        let builtin = registry.by_default().filter(|model| *model.origin() == Origin::Builtin);
        Ok(AssetRequest {
            name: name.to_owned(),
            models,
            spectrum: reading.spectrum_options()?,
            level,
            alternatives: builtin.cloned().collect(),
            strict: self.strict.unwrap_or_default(),
            grid: grid.transpose()?,
            keep_reference: self.keep_reference.unwrap_or_default(),
            coding: self.storage.unwrap_or_default(),
            recorded_only: self
                .recorded_only
                .unwrap_or(self.preset.is_some_and(Preset::recorded_only)),
            recorded_options: recorded,
            tool: tool.to_owned(),
            ..AssetRequest::default()
        })
    }
}

/// Returns the models with these names, each once. `all`, or an empty list, means the default
/// models ([`Registry::by_default`]). Models that the running program has added to the registry,
/// such as models written in Python, come last among the default models.
///
/// # Errors
/// When a model is unknown.
pub fn named_models(registry: &Registry, names: &[String]) -> Result<Vec<LoadedModel>, HostError> {
    let mut models: Vec<LoadedModel> = Vec::new();
    if names.is_empty() || names.iter().any(|name| name == "all") {
        let all = registry.by_default().cloned();
        let is_other = |model: &LoadedModel| matches!(model.origin(), Origin::Runtime(_));
        let (others, own): (Vec<_>, Vec<_>) = all.partition(is_other);
        models = [own, others].concat();
    }
    for name in names.iter().filter(|name| *name != "all") {
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
