//! `manifest.json`: the metadata of an asset.
//!
//! The writer leaves out keys that are absent or empty. Keys that this version does not know are
//! preserved and written back ([`Manifest::other`]).

use std::collections::BTreeMap;

use htex_model::Band;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::check_manifest::check_extension_name;
use crate::error::MetadataError;
use crate::law::{Contact, Law};
use crate::measure::{ErrorMeasure, Measure};
use crate::quality::{HeldOut, LeftOut, Quality};
#[cfg(feature = "schemars")]
use crate::schema_words::{
    DOI, ENTRY_NAME, MODEL_ID, SEMANTIC_VERSION, open_variants, own_entries, quantities_and_units,
};
use crate::triangles::Triangle;
use crate::{Fluctuation, Quantity};

/// The newest version of the format that this crate reads and writes. A writer gives an asset the
/// lowest version that defines all keys of the asset ([`Manifest::lowest_version`]).
pub const VERSION: &str = "1.1";
/// All versions that this crate writes, from the lowest on.
const VERSIONS: [&str; 2] = ["1.0", VERSION];

/// The extension that a coded asset requires. This extension adds fields that are compressed by a
/// range coder, and tables of conditions.
pub const CODED: &str = "org.htex.coded/1";

/// The extension of assets that are imported from the Penn Haptic Texture Toolkit.
pub const HATT: &str = "org.htex.hatt/1";

/// The manifest of an asset: the metadata of one surface and its models.
///
/// ```no_run
/// let asset = htex_format::Asset::open("sandpaper.htex".as_ref())?;
/// let manifest = &asset.manifest;
/// println!("{} at {} conditions", manifest.name, manifest.conditions.len());
/// # Ok::<(), htex_format::ReadError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(extend("oneOf" = quantities_and_units())))]
pub struct Manifest {
    /// Version of the format, `MAJOR.MINOR`.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = r"^1\.(0|[1-9][0-9]*)$")))]
    pub htex: String,
    /// Name of the texture.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = htex_base::schema::NOT_BLANK)))]
    pub name: String,
    /// SPDX licence expression of the asset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(length(min = 1)))]
    pub license: Option<String>,
    /// Author of the asset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// Search terms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// Description of the surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Origin of the recordings: a dataset, a laboratory, an address.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// DOI of the recordings or of the paper that describes them, without `https://doi.org/`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = DOI)))]
    pub doi: Option<String>,
    /// Kind and model of the sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
    /// What slid over the surface during the recording: a bare finger, an artificial fingertip or a
    /// tool.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finger: Option<String>,
    /// Kind of the sliding contact: a finger or a tool. If the manifest states no motion law, the
    /// contact decides which law a player assumes.
    #[serde(default, skip_serializing_if = "Contact::is_unknown")]
    pub contact: Contact,
    /// Physical quantity of the samples, e.g. the lateral force.
    pub quantity: Quantity,
    /// Unit of the samples: the unit that belongs to `quantity`.
    pub unit: String,
    /// Frequency band of the spectra.
    #[serde(with = "BandText")]
    #[cfg_attr(feature = "schemars", schemars(with = "BandText"))]
    pub band: Band,
    /// How the asset was made.
    #[serde(default, skip_serializing_if = "Provenance::is_empty")]
    pub provenance: Provenance,
    /// The conditions (speed and force) at which the texture was recorded.
    #[cfg_attr(feature = "schemars", schemars(length(min = 1), extend("uniqueItems" = true)))]
    pub conditions: Vec<Condition>,
    /// The motion law: how frequencies and level change at speeds and forces outside the recorded
    /// conditions. Without this key, the usual law for `contact` and `quantity` applies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<Law>,
    /// How strongly the level of the texture fluctuates over time. Without this key, the level does
    /// not fluctuate. From version 1.1 on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fluctuation: Option<Fluctuation>,
    /// The representations of the texture: each contains the parameters of one model.
    #[cfg_attr(feature = "schemars", schemars(length(min = 1), extend("uniqueItems" = true)))]
    pub representations: Vec<Representation>,
    /// The archive entry with the recorded spectra.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<Reference>,
    /// Embedded models, for players that do not have them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schemars", schemars(extend("uniqueItems" = true)))]
    pub plugins: Vec<Plugin>,
    /// Data of extensions, by the extension's name (`com.vendor.NAME/REV`).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub extensions: BTreeMap<String, Value>,
    /// Names of the extensions that a player must support to use the asset.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub extensions_required: Vec<String>,
    /// Keys that this version of the format does not know, e.g. from a newer minor version.
    #[serde(flatten)]
    #[cfg_attr(feature = "schemars", schemars(skip))]
    pub other: BTreeMap<String, Value>,
}

impl Manifest {
    /// Returns the law that the manifest states. If the manifest states no law, returns the law
    /// that players assume for the quantity and the contact.
    pub fn law(&self) -> Law {
        let assumed = || Law::assumed(self.quantity, self.contact);
        self.law.unwrap_or_else(assumed)
    }

    /// Returns the lowest version of the format that defines all keys of this manifest. A manifest
    /// with a version newer than [`VERSION`] keeps its version, because it may have keys that only
    /// the newer version defines.
    pub fn lowest_version(&self) -> String {
        if !VERSIONS.contains(&&*self.htex) {
            return self.htex.clone();
        }
        let since_1_1 = self.is_coded()
            || self.fluctuation.is_some()
            || self.conditions.iter().any(|c| c.repeatability_third_octave_rms_db.is_some());
        VERSIONS[usize::from(since_1_1)].to_owned()
    }

    /// Returns the held-out error at a condition of a representation; `None` if the manifest does
    /// not state it.
    pub fn held_out(&self, at: &AtCondition) -> Option<HeldOut> {
        let held_out_error_db = at.left_out?.0.get(Measure::ThirdOctave)?;
        // The repeatability applies to the whole recording. The two halves of a recording differ by
        // √2 times as much.
        let condition = self.conditions.get(at.condition)?;
        let second = condition.repeatability_third_octave_rms_db;
        let second = second.map(|db| db * std::f64::consts::SQRT_2).filter(|db| *db > 0.0);
        Some(HeldOut { held_out_error_db, held_out_error: second.map(|db| held_out_error_db / db) })
    }

    /// Sets extensions by their names. The value `null` removes an extension. Other extensions
    /// stay.
    ///
    /// # Errors
    ///
    /// Returns [`MetadataError::ExtensionName`] for a name that is not of the form
    /// `com.vendor.NAME/REVISION`. The manifest is then unchanged. Any name can be removed.
    pub fn set_extensions(&mut self, given: Map<String, Value>) -> Result<(), MetadataError> {
        for (name, value) in &given {
            if !value.is_null() {
                check_extension_name(name)?;
            }
        }
        for (name, value) in given {
            if value.is_null() {
                self.extensions.remove(&name);
            } else {
                self.extensions.insert(name, value);
            }
        }
        Ok(())
    }
}

/// A frequency band. The band includes both edges.
#[derive(Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(remote = "Band")]
#[cfg_attr(feature = "schemars", schemars(rename = "Band"))]
struct BandText {
    /// Lower edge, hertz, above 0.
    #[cfg_attr(feature = "schemars", schemars(range(max = 20000), extend("exclusiveMinimum" = 0)))]
    low_hz: f64,
    /// Upper edge, hertz, above the lower edge.
    #[cfg_attr(feature = "schemars", schemars(range(max = 20000), extend("exclusiveMinimum" = 0)))]
    high_hz: f64,
}

/// How an asset was made.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Provenance {
    /// Name and version of the program that wrote the asset.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub tool: String,
    /// Whether at least one recording comes from a simulator instead of a finger.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
    /// The recordings to which the models were fitted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub recordings: Vec<Source>,
    /// How the asset was made if it was not fitted to recordings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub made: Option<Made>,
    /// Options of the fit that differ from their defaults.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub options: BTreeMap<String, String>,
    /// Warnings that the author was shown when the asset was made.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

impl Provenance {
    fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// How an asset without recordings was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Made {
    /// The method.
    pub how: How,
    /// The assets that were mixed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub from: Vec<Ingredient>,
}

/// A method of making an asset without recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum How {
    /// The parameters were written by hand.
    Parameters,
    /// The parameters were interpolated between other assets.
    Mixed,
}

/// An asset that was mixed with other assets to make this asset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Ingredient {
    /// Name of the asset's texture.
    pub name: String,
    /// The asset's share of the mixture, from 0 to 1.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 1)))]
    pub weight: f64,
    /// BLAKE3 of the asset's file, 64 hexadecimal digits.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = "^[0-9A-Fa-f]{64}$")))]
    pub blake3: String,
}

/// A recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Source {
    /// File name without its folder.
    pub file: String,
    /// Sample rate, hertz.
    #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
    pub rate_hz: f64,
    /// Number of segments of the recording that were averaged.
    pub segments: u64,
    /// BLAKE3 of the recording's file, 64 hexadecimal digits. The hash distinguishes recordings
    /// with the same file name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = "^[0-9A-Fa-f]{64}$")))]
    pub blake3: Option<String>,
}

/// A condition: the speed and normal force of a recording. If the speed or the force is absent, it
/// is unknown.
///
/// ```
/// let condition = htex_format::Condition { speed_mm_s: Some(80.0), ..Default::default() };
/// assert_eq!(condition.force_n, None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Condition {
    /// Speed of the finger along the surface, mm/s, not negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 0)))]
    pub speed_mm_s: Option<f64>,
    /// Normal force, newtons, not negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 0)))]
    pub force_n: Option<f64>,
    /// Repeatability, decibels: an estimate of how much a second recording of the same surface
    /// would differ. To compute it, the levels of the odd and of the even blocks of the recording
    /// are compared in nine bands. The estimate is the RMS of the nine differences, divided by √2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 0)))]
    pub repeatability_rms_db: Option<f64>,
    /// The same as `repeatability_rms_db`, but computed over third octaves instead of nine bands.
    /// From version 1.1 on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 0)))]
    pub repeatability_third_octave_rms_db: Option<f64>,
    /// Number of recorded segments that were averaged at this condition, or 0 if the condition was
    /// interpolated between recorded conditions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub segments: Option<u64>,
}

/// Largest relative difference at which two speeds, or two forces, count as the same. When people
/// try to keep a speed or a force constant, they deviate from it by about this much.
pub const SAME_CONDITION: f64 = 0.05;

impl Condition {
    /// Returns whether the condition was recorded. Otherwise the condition was computed from
    /// recorded conditions, and its speed may lie outside the recorded speeds.
    pub fn is_recorded(&self) -> bool {
        self.segments != Some(0)
    }

    /// Returns whether two speeds, or two forces, are the same within [`SAME_CONDITION`]. Neither
    /// number may be negative.
    pub fn is_same(a: f64, b: f64) -> bool {
        (a - b).abs() <= SAME_CONDITION * a.max(b)
    }
}

/// A representation of the texture: the parameters of one model.
///
/// ```no_run
/// # let asset = htex_format::Asset::open("sandpaper.htex".as_ref())?;
/// for representation in &asset.manifest.representations {
///     println!("{} at {} conditions", representation.model, representation.at.len());
/// }
/// # Ok::<(), htex_format::ReadError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Representation {
    /// Reverse-DNS id of the model.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = MODEL_ID)))]
    pub model: String,
    /// Semantic version of the model that fitted the parameters.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = SEMANTIC_VERSION)))]
    pub model_version: String,
    /// Parameter fields, in their order in the flat parameter array.
    #[cfg_attr(feature = "schemars", schemars(extend("uniqueItems" = true)))]
    pub fields: Vec<StoredField>,
    /// The conditions for which the parameter block contains parameters, in the order of the block.
    #[cfg_attr(feature = "schemars", schemars(length(min = 1), extend("uniqueItems" = true)))]
    pub at: Vec<AtCondition>,
    /// A player interpolates in these triangles between conditions. Their corners are indices into
    /// `at`. If this list is empty, the rules of the specification determine the triangles. Invalid
    /// triangles are an error.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub triangles: Vec<Triangle>,
    /// Name of the archive entry that contains the parameter block.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = ENTRY_NAME), extend("not" = own_entries())))]
    pub parameters: String,
}

/// A parameter field and its storage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(rename = "Field"))]
pub struct StoredField {
    /// Name, as in the model's descriptor.
    #[cfg_attr(feature = "schemars", schemars(length(min = 1)))]
    pub name: String,
    /// Unit symbol; empty for a pure number.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Whether the field is a list of numbers instead of a single number.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub list: bool,
    /// Storage of each number.
    #[serde(default, skip_serializing_if = "StoredAs::is_f64")]
    pub store: StoredAs,
}

/// Storage of a number. The integer kinds store a whole number `q`. It stands for the value `offset
/// + scale·q`, or for `exp(offset + scale·q)` if `log` is set.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(rename = "Store"))]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "schemars", schemars(transform = open_variants))]
pub enum StoredAs {
    /// IEEE 754 binary64.
    #[default]
    F64,
    /// IEEE 754 binary32.
    F32,
    /// Unsigned 16-bit integer `q`.
    U16(Steps),
    /// Unsigned 8-bit integer `q`.
    U8(Steps),
    /// List of unsigned 8-bit integers `q`, stored as the differences between neighbours. Small
    /// differences take fewer bits.
    Packed(Steps),
    /// Unsigned 8-bit integers `q`, predicted from the previous condition and compressed by a range
    /// coder. Only coded assets use this storage. They require the extension `org.htex.coded/1`.
    Coded(Steps),
}

/// Step size and offset of an integer storage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Steps {
    /// Size of a step: the factor of `q`, above 0.
    #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
    pub scale: f64,
    /// Value for `q = 0`. If `log` is set, `offset` is the natural logarithm of that value.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub offset: f64,
    /// Whether `scale` and `offset` refer to the natural logarithm of the value.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub log: bool,
}

impl StoredAs {
    fn is_f64(&self) -> bool {
        *self == Self::F64
    }

    pub(crate) fn is_coded(&self) -> bool {
        matches!(self, Self::Coded(_))
    }
}

fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

impl Representation {
    /// Returns the error of this representation, in decibels. Programs compare these errors to
    /// choose among an asset's representations.
    ///
    /// This is the error at the first condition, where a voice starts. The first condition has no
    /// measured error if, for example, it was interpolated between recorded conditions. The result
    /// is then [`Self::largest_error_db`]. Returns `None` if no condition has a measured error.
    ///
    /// ```no_run
    /// # use htex_format::ErrorMeasure;
    /// # let asset = htex_format::Asset::open("sandpaper.htex".as_ref())?;
    /// for representation in &asset.manifest.representations {
    ///     println!("{}: {:?} dB", representation.model, representation.error_db(ErrorMeasure::NineBand));
    /// }
    /// # Ok::<(), htex_format::ReadError>(())
    /// ```
    pub fn error_db(&self, measure: ErrorMeasure) -> Option<f64> {
        let first = self.at.first().and_then(|at| at.error_db(measure));
        first.or_else(|| self.largest_error_db(measure))
    }

    /// Returns the largest of the errors at all conditions, in decibels. Returns `None` if no
    /// condition has a measured error.
    pub fn largest_error_db(&self, measure: ErrorMeasure) -> Option<f64> {
        let measured = self.at.iter().filter_map(|at| at.error_db(measure));
        measured.max_by(f64::total_cmp)
    }
}

impl AtCondition {
    fn error_db(&self, measure: ErrorMeasure) -> Option<f64> {
        self.quality.as_ref().and_then(|quality| measure.error_in(quality))
    }
}

/// One condition of a representation: the level and the accuracy of the fit.
///
/// ```no_run
/// # let asset = htex_format::Asset::open("sandpaper.htex".as_ref())?;
/// for at in &asset.manifest.representations[0].at {
///     let condition = asset.manifest.conditions[at.condition];
///     println!("{:?} mm/s: {} RMS", condition.speed_mm_s, at.level_rms);
/// }
/// # Ok::<(), htex_format::ReadError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct AtCondition {
    /// Index of the condition in the manifest's `conditions`.
    pub condition: usize,
    /// Level: the RMS of the fitted spectrum in the band, in the asset's unit. The parameters
    /// describe only the shape of the spectrum, which has an RMS of 1.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0)))]
    pub level_rms: f64,
    /// How well the model agrees with the recorded spectrum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quality: Option<Quality>,
    /// Left-out error. To measure it, a fit leaves out recorded blocks near this condition, and the
    /// fitted model is compared with these blocks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<LeftOut>,
}

/// The archive entry with the recorded spectra.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Reference {
    /// Name of the archive entry. The entry contains the recorded magnitudes for each condition, on
    /// the band's 5 Hz grid, as 32-bit floats, in the asset's unit.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = ENTRY_NAME), extend("not" = own_entries())))]
    pub file: String,
}

/// A model that is embedded in the asset, as a WASM module.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Plugin {
    /// Reverse-DNS id of the model.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = MODEL_ID)))]
    pub model: String,
    /// Semantic version of the model in the module.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = SEMANTIC_VERSION)))]
    pub version: String,
    /// Name of the archive entry that contains the module: `plugins/ID.wasm`.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = r"^plugins/[a-z0-9._-]+\.wasm$")))]
    pub file: String,
    /// BLAKE3 of the module, 64 lower-case hexadecimal digits.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = "^[0-9a-f]{64}$")))]
    pub blake3: String,
    /// Signature of the module's author.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signature: Option<Signature>,
}

/// An ed25519 signature over a plugin's model, version and hash.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Signature {
    /// The signer's public key, 64 hexadecimal digits.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = "^[0-9a-fA-F]{64}$")))]
    pub public_key: String,
    /// The signature, 128 hexadecimal digits.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = "^[0-9a-fA-F]{128}$")))]
    pub ed25519: String,
}
