//! The recipe as written in `library.toml`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use htex_author::Exploration;
use htex_author::settings::{FitSettings, Metadata, OneOrMore, ReadingSettings, one_or_more};
use htex_base::files::{AtFile, read_regular_text};
use htex_exchange::SignalSettings;
use htex_format::library::LibraryMetadata;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use crate::BuildError;
use crate::findings::unknown_code;
use crate::keys::check_keys;
use crate::remote::{RemoteFiles, joined, remote_location};

/// Largest size of a recipe, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// A recipe: which recordings to use, and how to make a library from them.
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
    /// The library to build.
    pub library: LibraryPart,
    /// Settings for all textures.
    #[serde(default)]
    pub defaults: Settings,
    /// Rules that find recordings, with the settings of their textures.
    #[schemars(length(min = 1))]
    pub textures: Vec<Textures>,
    /// Settings for individual textures. If several overrides match a texture, later overrides take
    /// precedence over earlier ones.
    #[serde(default)]
    pub overrides: Vec<Override>,
}

/// The library to build.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct LibraryPart {
    /// Name of the library and of its file.
    pub name: String,
    /// Metadata of the library itself, such as its version.
    #[serde(flatten)]
    pub metadata: LibraryMetadata,
    /// Plugins with models for the fit: WASM modules, which run in a sandbox. Paths are relative to
    /// the recipe. Native libraries run with all rights, so a recipe cannot name them. The user can
    /// name them with `htex build --plugin`.
    #[serde(default)]
    pub plugins: Vec<PathBuf>,
    /// What happens to textures of the existing library that the recipe no longer makes, e.g.
    /// because their recordings are archived.
    #[serde(default)]
    pub missing: MissingTextures,
    /// Largest number of textures that the library may lose. If the library would lose more
    /// textures, the build changes nothing and ends with an error.
    #[serde(default)]
    pub max_removed: Option<usize>,
}

/// What happens to textures of the existing library that the recipe no longer makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MissingTextures {
    /// They are removed.
    #[default]
    Remove,
    /// These textures stay in the library as they are, byte for byte.
    Keep,
}

/// A rule that finds recordings, with the settings of their textures.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Textures {
    /// Globs that find the files, relative to the recipe: `rec/**/*.csv`. The files can be
    /// recordings, or files that `htex import` takes: models of HaTT (`.xml`), `.haptic`, `.ahap`,
    /// `.hjif`.
    #[serde(default, deserialize_with = "one_or_more")]
    #[schemars(with = "OneOrMore", extend("default" = []))]
    pub recordings: Vec<String>,
    /// A CSV file with a row for each recording. The column `recording` contains the path of the
    /// recording's file, relative to the CSV file. Other columns are fields for templates. If the
    /// recipe does not state a name, speed or force, the columns `name`, `speed_mm_s` and `force_n`
    /// are used.
    #[serde(default)]
    pub table: Option<PathBuf>,
    /// A regular expression with named groups, which become fields for templates. The expression is
    /// matched against each file's path relative to the recipe, with `/` between folders. It is an
    /// error if the expression does not match a file.
    #[serde(default)]
    pub pattern: Option<String>,
    /// Name of the texture, as a template; `{stem}` by default. All recordings with the same name
    /// become one texture.
    #[serde(default)]
    pub name: Option<String>,
    /// Settings of these textures.
    #[serde(flatten)]
    pub settings: Settings,
}

/// Settings for individual textures.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Override {
    /// Globs for the names of the textures to which the settings apply.
    #[serde(deserialize_with = "one_or_more")]
    #[schemars(with = "OneOrMore")]
    pub textures: Vec<String>,
    /// Settings for these textures.
    #[serde(flatten)]
    pub settings: Settings,
}

/// Settings of textures. Texts in the metadata are templates, such as `{stem} at 80 mm/s`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Settings {
    /// How recordings are read. Paths of files are relative to the recipe. The tracker's path is a
    /// template.
    #[serde(flatten)]
    pub reading: ReadingSettings,
    /// Settings for values that a haptic file with a signal does not contain, such as the full
    /// scale.
    #[serde(flatten)]
    pub signal: SignalSettings,
    /// How models are fitted.
    #[serde(flatten)]
    pub fit: FitSettings,
    /// Who made the texture, and from what.
    #[serde(flatten)]
    pub metadata: Metadata,
    /// WASM modules with models: the build fits the models and then embeds the modules in the
    /// asset. Paths are relative to the recipe.
    pub embed_plugins: Option<Vec<PathBuf>>,
    /// Speed and normal force of the recordings.
    pub at: At,
    /// The requirements that an asset must meet to be in the library.
    pub gates: Gates,
}

/// Speed and normal force of recordings. Each value is a number, or a template that gives a number.
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

/// Returns the schema for a number from 0 to `most`, or a template.
fn number_or_template(most: f64) -> Schema {
    json_schema!({ "anyOf": [{ "type": "number", "minimum": 0, "maximum": most }, { "type": "string" }] })
}

/// A number, or a template that gives a number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum NumberOrTemplate {
    /// A number.
    Number(f64),
    /// A template.
    Template(String),
}

/// The requirements that an asset must meet to be in the library. An absent gate requires nothing.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Gates {
    /// Largest allowed nine-band RMS error of a representation, at any condition, decibels. One
    /// number for all models, or a table with a number for each model.
    pub max_band_error_db: Option<ModelGate>,
    /// Largest allowed felt difference between a representation and its recording, at any
    /// condition, decibels. The felt difference is the difference of the levels above the detection
    /// threshold. The gate applies to each third-octave band and to all bands together. A
    /// difference below 1.584 dB (the difference threshold) is too small to notice. One number for
    /// all models, or a table with a number for each model.
    pub max_felt_error_db: Option<ModelGate>,
    /// Largest allowed repeatability value of a condition, decibels. This value is the RMS
    /// difference between odd and even blocks of time, over nine bands, divided by √2.
    pub max_repeatability_db: Option<f64>,
    /// Codes of forbidden findings, such as `RECORDING_CLIPPED`. A texture is left out of the
    /// library if any of its recordings has such a finding.
    pub deny: Option<Vec<String>>,
    /// Smallest number of 0.2 s segments that every condition must have.
    pub min_segments: Option<usize>,
    /// Whether to refuse recordings with findings that are errors or warnings, such as an unsteady
    /// motion or clipping.
    pub strict: Option<bool>,
    /// Whether every texture must state a licence. By default, textures from files of other haptic
    /// formats must state a licence, and textures from recordings need not state one.
    pub license: Option<bool>,
    /// Largest allowed size of the asset, bytes.
    pub max_bytes: Option<u64>,
}

/// The largest allowed error of models, decibels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ModelGate {
    /// One number for all models.
    All(f64),
    /// A number for each model, by short name or id.
    ByModel(BTreeMap<String, f64>),
}

impl Recipe {
    /// Parses the text of a recipe.
    ///
    /// # Errors
    /// Returns an error if the text is not TOML, has keys or values that a recipe cannot have, or
    /// lists in `gates.deny` a code that no finding has.
    pub fn parse(text: &str) -> Result<Self, BuildError> {
        // Flattened settings cannot refuse unknown keys themselves.
        check_keys(text, &htex_base::files::toml::from_str(text)?)?;
        let recipe: Self = htex_base::files::toml::from_str(text)?;
        recipe.check_codes()?;
        Ok(recipe)
    }

    /// Refuses gates for codes that no finding has.
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

    /// Reads a recipe from a file, given by path or URI.
    ///
    /// # Errors
    /// Returns the errors of [`Self::parse`], and an error if the file cannot be read.
    pub fn open(file: &Path) -> Result<Self, BuildError> {
        let text = match remote_location(file)? {
            Some(location) => RemoteFiles::temporary(Some(location.clone())).text(&location)?,
            None => read_regular_text(file, MOST_BYTES).reading(file)?,
        };
        Self::parse(&text)
    }
}

impl Settings {
    /// Returns these settings, with missing ones taken from `under`. Options and gates are merged
    /// one by one.
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

    /// Returns how recordings are read. The tracker is left out, because each recording has its
    /// own.
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
