//! Drive voltages (gains), one for each combination of a person, a texture and a device. Each
//! person adjusts the voltage (V_g in the paper) while feeling the texture. The voltages are stored
//! in a file in the user's configuration folder.
//!
//! A gain belongs to a texture, not to a file. The key of a gain contains the texture's name and
//! author, because name and author stay the same after a new fit. The key contains no hash of the
//! recordings, because this hash would change if a recording were added. The gain also stores the
//! RMS at which the voltage was adjusted. If levels are not normalised, a representation (a model's
//! parameters in the asset) with another RMS is therefore played proportionally stronger or weaker.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use htex_format::Manifest;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Level at which the adjustment of a gain starts, decibels relative to the maximum. -20 dB is a
/// tenth of the maximum voltage. The voltage rises only when the person increases it.
pub const START_DB: f64 = -20.0;

/// Converts decibels to an amplitude factor.
pub fn factor_of_db(db: f64) -> f64 {
    libm::pow(10.0, db / 20.0)
}

/// Size limit of a gains file, bytes.
const MAX_BYTES: u64 = 16 << 20;

/// Key of a gain: person, texture and device.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct GainKey {
    /// Name of the person.
    pub person: String,
    /// Identifier of the texture ([`texture_id`]). The identifier is empty in legacy entries, which
    /// identify the texture by the hash of a file.
    #[serde(default)]
    pub texture: String,
    /// Id of the device's adapter.
    pub device: String,
    /// The device's profile. Empty if there is none.
    pub profile: String,
}

/// An adjusted gain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(deny_unknown_fields))]
pub struct Gain {
    /// Person, texture and device.
    #[serde(flatten)]
    pub key: GainKey,
    /// Name of the file that was played when the gain was adjusted. The name is only displayed.
    pub file: String,
    /// Largest voltage of the drive, volts: V_g times sqrt(2).
    #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
    pub drive_v: f64,
    /// RMS that is mapped to this drive voltage, in the assets' unit. If levels are not normalised,
    /// representations with another RMS are played stronger or weaker in proportion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(extend("exclusiveMinimum" = 0)))]
    pub reference_rms: Option<f64>,
    /// Names of the texture's recordings. These names distinguish textures with the same name and
    /// author.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub recordings: Vec<String>,
    /// BLAKE3 hash of the asset or scene, hexadecimal. Legacy entries use it as their identifier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blake3: Option<String>,
}

/// The contents of a gains file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(deny_unknown_fields))]
pub struct Gains {
    /// All gains. No two gains have the same key.
    pub gains: Vec<Gain>,
}

/// Returns the keys of a gains file, as a JSON Schema.
fn keys() -> Value {
    json!({
        "type": "object",
        "additionalProperties": false,
        "properties": { "gains": { "type": "array", "items": {
            "type": "object",
            "additionalProperties": false,
            "properties": {
                "person": {}, "texture": {}, "device": {}, "profile": {}, "file": {}, "drive_v": {},
                "reference_rms": {}, "recordings": {}, "blake3": {},
            },
        } } },
    })
}

/// Returns the identifier of a texture: its name and, if present, its author, both normalised by
/// [`texture_name`]. All assets of the texture have the same identifier, no matter when and how
/// they were fitted. If several textures are played together, the identifier is the sorted list of
/// their identifiers, joined by ` + `.
pub fn texture_id<'a>(textures: impl IntoIterator<Item = &'a Manifest>) -> String {
    let id = |texture: &Manifest| match texture.author.as_deref().map(texture_name) {
        Some(author) if !author.is_empty() => {
            format!("{} by {author}", texture_name(&texture.name))
        }
        _ => texture_name(&texture.name),
    };
    let ids: BTreeSet<String> = textures.into_iter().map(id).collect();
    Vec::from_iter(ids).join(" + ")
}

/// Normalises a name: lower case, words separated by single spaces.
pub fn texture_name(name: &str) -> String {
    let words: Vec<String> = name.split_whitespace().map(str::to_lowercase).collect();
    words.join(" ")
}

/// Returns the names of the textures' recordings, sorted and without duplicates.
pub fn recordings_of<'a>(textures: impl IntoIterator<Item = &'a Manifest>) -> Vec<String> {
    let recordings = textures.into_iter().flat_map(|t| &t.provenance.recordings);
    let names: BTreeSet<String> = recordings.map(|source| source.file.clone()).collect();
    names.into_iter().collect()
}

impl Gains {
    /// Returns the hash of an asset or scene, as legacy entries store it.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn hash_of(file: &Path) -> io::Result<String> {
        Ok(blake3::hash(&fs::read(file)?).to_hex().to_string())
    }

    /// Returns the path of the user's file of gains. The file `gains.json` is in the folder
    /// `$HTEX_CONFIG_DIR` if this variable is set. Otherwise it is in the folder `htex` in the
    /// user's configuration folder. Returns `None` if there is no configuration folder.
    pub fn user_file() -> Option<PathBuf> {
        htex_host::folders::config().map(|folder| folder.join("gains.json"))
    }

    /// Reads a gains file. If the file is missing, the result has no gains.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, is too large, or is not a gains file. Also
    /// returns an error if the file has unknown keys, which would be lost when the file is written
    /// again.
    pub fn load(path: &Path) -> io::Result<Self> {
        let bytes = match fs::metadata(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(error) => return Err(error),
            // Checked before the file is read into memory.
            Ok(found) if found.len() > MAX_BYTES => {
                return Err(io::Error::other("the file is too large for a gains file"));
            }
            Ok(_) => fs::read(path)?,
        };
        Self::from_json(serde_json::from_slice(&bytes)?)
    }

    /// Reads gains from the contents of a gains file.
    ///
    /// # Errors
    /// Returns an error if the contents are not a gains file. Also returns an error if they have
    /// unknown keys, which would be lost when the file is written again.
    pub fn from_json(document: Value) -> io::Result<Self> {
        let unknown = htex_base::schema::unknown_keys(&keys(), &document);
        if !unknown.is_empty() {
            let sentences: Vec<String> = unknown.iter().map(ToString::to_string).collect();
            return Err(io::Error::other(sentences.join("\n")));
        }
        let gains: Self = serde_json::from_value(document)?;
        let is_sound =
            |gain: &Gain| gain.drive_v > 0.0 && gain.reference_rms.is_none_or(|rms| rms > 0.0);
        match gains.gains.iter().find(|gain| !is_sound(gain)) {
            None => Ok(gains),
            Some(gain) => Err(io::Error::other(format!(
                "the gain of {:?} for {:?} has a voltage or a reference level that is not above 0; adjust it again",
                gain.key.person, gain.key.texture
            ))),
        }
    }

    /// Reads the file, applies `change`, and replaces the file atomically. Concurrent programs wait
    /// for each other. Creates the folder if it is missing.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::load`]. Also returns an error if the file cannot be
    /// written.
    #[allow(clippy::disallowed_methods, reason = "the user's own folder of settings")]
    pub fn update(path: &Path, change: impl FnOnce(&mut Self)) -> io::Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        // The lock is a separate file, because the gains file itself is replaced.
        let lock = fs::File::create(path.with_extension("lock"))?;
        lock.lock()?;
        let mut gains = Self::load(path)?;
        change(&mut gains);
        let text = serde_json::to_string_pretty(&gains)? + "\n";
        htex_format::write_file(path, text.as_bytes())
    }

    /// Returns the gain for a key. If there is no such gain, returns the legacy entry for the same
    /// person, the same device and a file with this hash.
    pub fn find(&self, key: &GainKey, blake3: &str) -> Option<&Gain> {
        let exact = self.gains.iter().find(|gain| gain.key == *key);
        exact.or_else(|| self.gains.iter().find(|gain| gain.is_of_old(key, blake3)))
    }

    /// Inserts a gain. The new gain replaces an earlier gain with the same key. It also replaces a
    /// legacy entry for the same person, the same device and a file with this hash.
    pub fn put(&mut self, gain: Gain, blake3: &str) {
        let replaced = |other: &Gain| other.key == gain.key || other.is_of_old(&gain.key, blake3);
        self.gains.retain(|other| !replaced(other));
        self.gains.push(gain);
    }
}

impl Gain {
    fn is_of_old(&self, key: &GainKey, blake3: &str) -> bool {
        let own = &self.key;
        let same = (&own.person, &own.device, &own.profile);
        own.texture.is_empty()
            && self.blake3.as_deref() == Some(blake3)
            && same == (&key.person, &key.device, &key.profile)
    }
}

#[cfg(all(test, feature = "schemars"))]
mod tests {
    use super::*;

    #[test]
    fn the_keys_are_those_of_the_schema() {
        let names = |of: &Value| {
            let names = of["properties"].as_object().unwrap().keys();
            names.cloned().collect::<BTreeSet<String>>()
        };
        let (keys, schema) = (keys(), crate::gains_schema());
        assert_eq!(names(&keys), names(&schema));
        assert_eq!(names(&keys["properties"]["gains"]["items"]), names(&schema["$defs"]["Gain"]));
    }
}
