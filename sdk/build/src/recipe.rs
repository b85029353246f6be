//! The recipe, as it is written: `library.toml`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use htex_author::settings::{FitSettings, Metadata, OptionSetting, ReadingSettings};
use htex_author::{Averaging, Level, SegmentChoice};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::BuildError;
use crate::elsewhere::{Elsewhere, elsewhere, joined};

/// A recipe: recordings, and how a library is made of them.
///
/// ```
/// let recipe = htex_build::Recipe::parse(r#"
///     [library]
///     name = "vinyls"
///     [[textures]]
///     recordings = "rec/*.csv"
///     models = ["bands", "sbeta"]
///     license = "CC0-1.0"
///     at = { speed_mm_s = 80, force_n = 0.4 }
/// "#)?;
/// assert_eq!(recipe.library.name, "vinyls");
/// # Ok::<(), htex_build::BuildError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// The library.
    pub library: LibraryPart,
    /// Settings of all textures.
    #[serde(default)]
    pub defaults: Settings,
    /// Recordings, and settings of their textures.
    #[schemars(length(min = 1))]
    pub textures: Vec<Textures>,
    /// Settings of single textures, laid over the others in their order.
    #[serde(default)]
    pub overrides: Vec<Override>,
}

/// The library that is built.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LibraryPart {
    /// Name of the library and of its file.
    pub name: String,
    /// Plugins of models to fit with: WASM modules, or native libraries, which run with all your rights. Relative to the recipe.
    #[serde(default)]
    pub plugins: Vec<PathBuf>,
}

/// Recordings, and settings of their textures.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Textures {
    /// Files by glob, relative to the recipe: `rec/**/*.csv`.
    #[serde(default)]
    pub recordings: OneOrMore,
    /// A CSV with a row for each recording: the column `recording` is its file, relative to the table; other columns are fields of
    /// templates. `name`, `speed_mm_s` and `force_n` are used where the recipe says nothing else.
    #[serde(default)]
    pub table: Option<PathBuf>,
    /// A regular expression with named groups, which become fields of templates. It is matched against each file's path relative to
    /// the recipe, with `/` between folders; a file that it does not match is an error.
    #[serde(default)]
    pub pattern: Option<String>,
    /// Name of the texture, a template; `{stem}` when absent. Recordings with the same name are one texture.
    #[serde(default)]
    pub name: Option<String>,
    /// Settings of these textures.
    #[serde(flatten)]
    pub settings: Settings,
}

/// Settings of single textures.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Override {
    /// Names of textures, by glob.
    pub textures: OneOrMore,
    /// Their settings.
    #[serde(flatten)]
    pub settings: Settings,
}

/// A text, or several.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum OneOrMore {
    /// One.
    One(String),
    /// Several.
    Several(Vec<String>),
    /// None.
    #[default]
    #[serde(skip)]
    None,
}

impl OneOrMore {
    pub(crate) fn as_slice(&self) -> &[String] {
        match self {
            Self::None => &[],
            Self::One(glob) => std::slice::from_ref(glob),
            Self::Several(globs) => globs,
        }
    }
}

/// Settings of textures; texts of metadata are templates.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Settings {
    /// Models by short name or id, in the order of the representations; all when absent.
    pub models: Option<Vec<String>>,
    /// Fit options: `options.ar.order = 6`.
    pub options: BTreeMap<String, ModelOptions>,
    /// Level of the representations.
    pub level: Option<Level>,
    /// Grid of conditions for recordings in which speed and force change freely: `auto`, or lines such as `speed=40,80,160` and
    /// `force=0.3,0.6`.
    pub grid: OneOrMore,
    /// Whether to keep the recorded spectra in the asset.
    pub keep_reference: Option<bool>,
    /// WASM modules to fit with and to bring along in the asset. Relative to the recipe.
    pub embed_plugins: Option<Vec<PathBuf>>,
    /// Speed and normal force of the recordings.
    pub at: At,
    /// What an asset must hold to be in the library.
    pub gates: Gates,
    /// Who made it.
    pub author: Option<String>,
    /// SPDX licence expression.
    pub license: Option<String>,
    /// What the surface is.
    pub description: Option<String>,
    /// Search terms.
    pub tags: Option<Vec<String>>,
    /// Where the recordings come from.
    pub source: Option<String>,
    /// DOI of the recordings or of the paper that describes them.
    pub doi: Option<String>,
    /// What measured the signal.
    pub sensor: Option<String>,
    /// What slid over the surface.
    pub finger: Option<String>,
    /// Sampling rate of the recordings, hertz, where the files do not say.
    pub rate_hz: Option<f64>,
    /// Names and scales of the recordings' columns, as the command's `--map`.
    pub map: Option<String>,
    /// File of a tracker with the finger's motion for each recording, a template, relative to the recipe.
    pub tracker: Option<String>,
    /// Names and scales of the trackers' columns, as the command's `--tracker-map`.
    pub tracker_map: Option<String>,
    /// Quantity of the texture's signal.
    pub quantity: Option<htex_format::Quantity>,
    /// Value of a full-scale sample, in the quantity's unit.
    pub scale: Option<f64>,
    /// File of the setup's response, relative to the recipe.
    pub response: Option<PathBuf>,
    /// Start of the part to read, seconds.
    pub from_s: Option<f64>,
    /// End of the part to read, seconds.
    pub to_s: Option<f64>,
    /// Method of choosing segments.
    pub segments: Option<SegmentChoice>,
    /// Method of averaging segments.
    pub averaging: Option<Averaging>,
}

/// Options of a model by name.
pub type ModelOptions = BTreeMap<String, OptionSetting>;

/// Speed and normal force: numbers, or templates that stand for numbers.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct At {
    /// Speed, mm/s.
    pub speed_mm_s: Option<NumberOrTemplate>,
    /// Normal force, newtons.
    pub force_n: Option<NumberOrTemplate>,
}

/// A number, or a template that stands for one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum NumberOrTemplate {
    /// A number.
    Number(f64),
    /// A template.
    Template(String),
}

/// What an asset must hold to be in the library; an absent gate asks for nothing.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Gates {
    /// Largest nine-band RMS error of every representation at every condition, decibels; or by model.
    pub max_band_error_db: Option<BandErrorGate>,
    /// Fewest segments of 0.2 s at every condition.
    pub min_segments: Option<usize>,
    /// Whether recordings may have no findings that are errors or warnings: a steady motion on target, no clipping, …
    pub strict: Option<bool>,
    /// Whether a licence must be stated.
    pub license: Option<bool>,
    /// Largest size of the asset, bytes.
    pub max_bytes: Option<u64>,
}

/// The gate of band errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum BandErrorGate {
    /// Of all models.
    All(f64),
    /// Of single models, by short name or id.
    ByModel(BTreeMap<String, f64>),
}

impl Recipe {
    /// Reads a recipe's text.
    ///
    /// # Errors
    /// When it is not TOML, or has other keys or values than a recipe.
    pub fn parse(text: &str) -> Result<Self, BuildError> {
        toml::from_str(text).map_err(|error| BuildError::Recipe {
            problem: error.to_string().trim_end().to_owned(),
        })
    }

    /// Reads a recipe's file, a path or URI.
    ///
    /// # Errors
    /// As [`Self::parse`], and when the file cannot be read.
    pub fn open(file: &Path) -> Result<Self, BuildError> {
        let text = match elsewhere(file)? {
            Some(location) => Elsewhere::temporary().text(&location)?,
            None => std::fs::read_to_string(file).map_err(|error| BuildError::read(file, error))?,
        };
        Self::parse(&text)
    }
}

impl Settings {
    /// Returns these settings, and where they are absent those of `under`; options and gates are laid over each other one by one.
    pub(crate) fn over(self, under: Self) -> Self {
        let mut options = under.options;
        for (model, own) in self.options {
            options.entry(model).or_default().extend(own);
        }
        Self {
            models: self.models.or(under.models),
            options,
            level: self.level.or(under.level),
            grid: match self.grid {
                OneOrMore::None => under.grid,
                own => own,
            },
            keep_reference: self.keep_reference.or(under.keep_reference),
            embed_plugins: self.embed_plugins.or(under.embed_plugins),
            at: At {
                speed_mm_s: self.at.speed_mm_s.or(under.at.speed_mm_s),
                force_n: self.at.force_n.or(under.at.force_n),
            },
            gates: self.gates.over(under.gates),
            author: self.author.or(under.author),
            license: self.license.or(under.license),
            description: self.description.or(under.description),
            tags: self.tags.or(under.tags),
            source: self.source.or(under.source),
            doi: self.doi.or(under.doi),
            sensor: self.sensor.or(under.sensor),
            finger: self.finger.or(under.finger),
            rate_hz: self.rate_hz.or(under.rate_hz),
            map: self.map.or(under.map),
            tracker: self.tracker.or(under.tracker),
            tracker_map: self.tracker_map.or(under.tracker_map),
            quantity: self.quantity.or(under.quantity),
            scale: self.scale.or(under.scale),
            response: self.response.or(under.response),
            from_s: self.from_s.or(under.from_s),
            to_s: self.to_s.or(under.to_s),
            segments: self.segments.or(under.segments),
            averaging: self.averaging.or(under.averaging),
        }
    }

    pub(crate) fn reading(&self, recipe_folder: &Path) -> ReadingSettings {
        ReadingSettings {
            rate_hz: self.rate_hz,
            map: self.map.clone(),
            tracker_map: self.tracker_map.clone(),
            quantity: self.quantity,
            scale: self.scale,
            response: self
                .response
                .as_ref()
                .map(|file| joined(recipe_folder, file)),
            from_s: self.from_s,
            to_s: self.to_s,
            segments: self.segments,
            averaging: self.averaging,
            ..ReadingSettings::default()
        }
    }

    pub(crate) fn fit(&self) -> FitSettings {
        let options = self.options.iter().flat_map(|(model, own)| {
            let named = move |(name, value): (&String, &OptionSetting)| {
                (format!("{model}.{name}"), value.clone())
            };
            own.iter().map(named)
        });
        FitSettings {
            models: self.models.clone(),
            options: options.collect(),
            level: self.level,
            keep_reference: self.keep_reference,
            strict: self.gates.strict,
            grid: Some(self.grid.as_slice().to_vec()).filter(|lines| !lines.is_empty()),
        }
    }

    /// Returns the metadata, its texts still templates.
    pub(crate) fn metadata(&self) -> Metadata {
        Metadata {
            name: None,
            author: self.author.clone(),
            license: self.license.clone(),
            description: self.description.clone(),
            tags: self.tags.clone(),
            source: self.source.clone(),
            doi: self.doi.clone(),
            sensor: self.sensor.clone(),
            finger: self.finger.clone(),
        }
    }
}

impl Gates {
    fn over(self, under: Self) -> Self {
        Self {
            max_band_error_db: self.max_band_error_db.or(under.max_band_error_db),
            min_segments: self.min_segments.or(under.min_segments),
            strict: self.strict.or(under.strict),
            license: self.license.or(under.license),
            max_bytes: self.max_bytes.or(under.max_bytes),
        }
    }
}
