//! The recipe, as it is written: `library.toml`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use htex_author::Exploration;
use htex_author::settings::{FitSettings, Metadata, OneOrMore, ReadingSettings, one_or_more};
use htex_exchange::SignalSettings;
use htex_files::{AtFile, read_regular_text};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use crate::BuildError;
use crate::elsewhere::{Elsewhere, elsewhere, joined};
use crate::findings::unknown_code;
use crate::keys::check_keys;

/// Most bytes of a recipe.
const MOST_BYTES: u64 = 1 << 20;

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
    /// Plugins of models to fit with: WASM modules, which run in a sandbox. Relative to the recipe.
    /// A native library, which runs with all rights, is named by a person alone:
    /// `htex build --plugin`.
    #[serde(default)]
    pub plugins: Vec<PathBuf>,
}

/// Recordings, and settings of their textures.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Textures {
    /// Files by glob, relative to the recipe: `rec/**/*.csv`. Recordings, and what `htex import`
    /// takes: models of HaTT (`.xml`), `.haptic`, `.ahap`, `.hjif`.
    #[serde(default, deserialize_with = "one_or_more")]
    #[schemars(with = "OneOrMore", extend("default" = []))]
    pub recordings: Vec<String>,
    /// A CSV with a row for each recording: the column `recording` is its file, relative to the
    /// table; other columns are fields of templates. `name`, `speed_mm_s` and `force_n` are used
    /// where the recipe says nothing else.
    #[serde(default)]
    pub table: Option<PathBuf>,
    /// A regular expression with named groups, which become fields of templates. It is matched
    /// against each file's path relative to the recipe, with `/` between folders; a file that it
    /// does not match is an error.
    #[serde(default)]
    pub pattern: Option<String>,
    /// Name of the texture, a template; `{stem}` when absent. Recordings with the same name are one
    /// texture.
    #[serde(default)]
    pub name: Option<String>,
    /// Settings of these textures.
    #[serde(flatten)]
    pub settings: Settings,
}

/// Settings of single textures.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Override {
    /// Names of textures, by glob.
    #[serde(deserialize_with = "one_or_more")]
    #[schemars(with = "OneOrMore")]
    pub textures: Vec<String>,
    /// Their settings.
    #[serde(flatten)]
    pub settings: Settings,
}

/// Settings of textures; texts of metadata are templates.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Settings {
    /// How recordings are read; files are relative to the recipe, that of the tracker is a
    /// template.
    #[serde(flatten)]
    pub reading: ReadingSettings,
    /// What haptic signals of other formats do not say.
    #[serde(flatten)]
    pub signal: SignalSettings,
    /// How models are fitted.
    #[serde(flatten)]
    pub fit: FitSettings,
    /// Who made the texture, and of what.
    #[serde(flatten)]
    pub metadata: Metadata,
    /// WASM modules to fit with and to bring along in the asset. Relative to the recipe.
    pub embed_plugins: Option<Vec<PathBuf>>,
    /// Speed and normal force of the recordings.
    pub at: At,
    /// What an asset must hold to be in the library.
    pub gates: Gates,
}

/// Speed and normal force: numbers, or templates that stand for numbers.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct At {
    /// Speed, mm/s.
    #[schemars(schema_with = "speed")]
    pub speed_mm_s: Option<NumberOrTemplate>,
    /// Normal force, newtons.
    #[schemars(schema_with = "force")]
    pub force_n: Option<NumberOrTemplate>,
}

fn speed(_: &mut SchemaGenerator) -> Schema {
    number_or_template(Exploration::MOST_SPEED_MM_S)
}

fn force(_: &mut SchemaGenerator) -> Schema {
    number_or_template(Exploration::MOST_FORCE_N)
}

/// Returns the schema of a number from 0 to a largest one, or a template.
fn number_or_template(most: f64) -> Schema {
    json_schema!({ "anyOf": [{ "type": "number", "minimum": 0, "maximum": most }, { "type": "string" }] })
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
    /// Largest nine-band RMS error of every representation at every condition, decibels; or by
    /// model.
    pub max_band_error_db: Option<ModelGate>,
    /// Largest difference from the recording that is felt of every representation at every
    /// condition, of a third-octave band or of all together above the detection threshold,
    /// decibels; or by model. The difference threshold is 1.584 dB.
    pub max_felt_error_db: Option<ModelGate>,
    /// Largest repeatability of a condition: the RMS over nine bands of the difference between odd
    /// and even blocks of time, over √2, decibels.
    pub max_repeatability_db: Option<f64>,
    /// Codes of findings that recordings may not have, such as `RECORDING_CLIPPED`.
    pub deny: Option<Vec<String>>,
    /// Fewest segments of 0.2 s at every condition.
    pub min_segments: Option<usize>,
    /// Whether recordings may have no findings that are errors or warnings: a steady motion on
    /// target, no clipping, …
    pub strict: Option<bool>,
    /// Whether a licence must be stated; of files of other haptic formats it must unless this is
    /// false.
    pub license: Option<bool>,
    /// Largest size of the asset, bytes.
    pub max_bytes: Option<u64>,
}

/// A gate of errors of models, decibels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ModelGate {
    /// Of all models.
    All(f64),
    /// Of single models, by short name or id.
    ByModel(BTreeMap<String, f64>),
}

impl Recipe {
    /// Reads a recipe's text.
    ///
    /// # Errors
    /// When it is not TOML, or has other keys or values than a recipe, or a gate by a code that no
    /// finding has.
    pub fn parse(text: &str) -> Result<Self, BuildError> {
        check_keys(text, &htex_files::toml::from_str(text)?)?;
        let recipe: Self = htex_files::toml::from_str(text)?;
        recipe.check_codes()?;
        Ok(recipe)
    }

    /// Refuses gates by codes that no finding has.
    fn check_codes(&self) -> Result<(), BuildError> {
        let textures = self.textures.iter().map(|textures| &textures.settings);
        let overrides = self.overrides.iter().map(|over| &over.settings);
        let settings = std::iter::once(&self.defaults).chain(textures).chain(overrides);
        let mut codes = settings.flat_map(|settings| settings.gates.deny.iter().flatten());
        match codes.find_map(|code| unknown_code(code)) {
            None => Ok(()),
            Some(problem) => Err(BuildError::Recipe(format!("gates.deny: {problem}"))),
        }
    }

    /// Reads a recipe's file, a path or URI.
    ///
    /// # Errors
    /// As [`Self::parse`], and when the file cannot be read.
    pub fn open(file: &Path) -> Result<Self, BuildError> {
        let text = match elsewhere(file)? {
            Some(location) => Elsewhere::temporary(Some(location.clone())).text(&location)?,
            None => read_regular_text(file, MOST_BYTES).reading(file)?,
        };
        Self::parse(&text)
    }
}

impl Settings {
    /// Returns these settings, and where they are absent those of `under`; options and gates are
    /// laid over each other one by one.
    pub(crate) fn over(self, under: Self) -> Self {
        Self {
            reading: self.reading.over(under.reading),
            signal: self.signal.over(under.signal),
            fit: self.fit.over(under.fit),
            metadata: self.metadata.over(under.metadata),
            embed_plugins: self.embed_plugins.or(under.embed_plugins),
            at: At {
                speed_mm_s: self.at.speed_mm_s.or(under.at.speed_mm_s),
                force_n: self.at.force_n.or(under.at.force_n),
            },
            gates: self.gates.over(under.gates),
        }
    }

    /// Returns how recordings are read, but for the tracker's, which is a file of each of them.
    pub(crate) fn reading(&self, recipe_folder: &Path) -> ReadingSettings {
        let response = self.reading.response.as_ref();
        ReadingSettings {
            response: response.map(|file| joined(recipe_folder, file)),
            tracker: None,
            ..self.reading.clone()
        }
    }

    pub(crate) fn fit(&self) -> FitSettings {
        FitSettings {
            strict: self.gates.strict,
            grid: self.fit.grid.clone().filter(|lines| !lines.is_empty()),
            ..self.fit.clone()
        }
    }
}

impl Gates {
    fn over(self, under: Self) -> Self {
        Self {
            max_band_error_db: self.max_band_error_db.or(under.max_band_error_db),
            max_felt_error_db: self.max_felt_error_db.or(under.max_felt_error_db),
            max_repeatability_db: self.max_repeatability_db.or(under.max_repeatability_db),
            deny: self.deny.or(under.deny),
            min_segments: self.min_segments.or(under.min_segments),
            strict: self.strict.or(under.strict),
            license: self.license.or(under.license),
            max_bytes: self.max_bytes.or(under.max_bytes),
        }
    }
}
