//! How strong a drive each person wants to feel a surface on a device: V_g of the paper, found by
//! adjustment, kept in a file of the user's own.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use htex_format::Manifest;
use serde::{Deserialize, Serialize};

/// Largest file that is read, bytes.
const MAX_BYTES: u64 = 16 << 20;

/// What a gain is for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct GainKey {
    /// Who feels it.
    pub person: String,
    /// What is felt: see [`texture_id`]. Empty in entries of old, which have a hash instead.
    #[serde(default)]
    pub texture: String,
    /// Id of the device's adapter.
    pub device: String,
    /// The device's profile; empty when there is none.
    pub profile: String,
}

/// A gain that was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// What it is for.
    #[serde(flatten)]
    pub key: GainKey,
    /// Name of the file it was found with, for people.
    pub file: String,
    /// Largest voltage of the drive, volts: V_g times sqrt(2).
    pub drive_v: f64,
    /// RMS that had this drive, in the assets' unit: what other representations are measured by where levels are not normalised.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_rms: Option<f64>,
    /// Names of the files that the texture was recorded in: they tell two textures of one name apart.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub recordings: Vec<String>,
    /// BLAKE3 hash of the asset or scene, hexadecimal, by which gains were kept before textures had names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blake3: Option<String>,
}

/// The gains in a file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Gains {
    /// All of them, each key once.
    pub gains: Vec<Gain>,
}

/// What assets of one texture share, however and whenever they were fitted: the name and, where there is one, the
/// author, as [`texture_name`] has them. For several textures that are felt together: all of them, in order.
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

/// A name in lower case, its words with one space between them.
pub fn texture_name(name: &str) -> String {
    let words: Vec<String> = name.split_whitespace().map(str::to_lowercase).collect();
    words.join(" ")
}

/// Names of the files that textures were recorded in, in order.
pub fn recordings_of<'a>(textures: impl IntoIterator<Item = &'a Manifest>) -> Vec<String> {
    let recordings = textures.into_iter().flat_map(|t| &t.provenance.recordings);
    let names: BTreeSet<String> = recordings.map(|source| source.file.clone()).collect();
    names.into_iter().collect()
}

impl Gains {
    /// The hash of an asset or scene, as entries of old have it.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn hash_of(file: &Path) -> io::Result<String> {
        Ok(blake3::hash(&fs::read(file)?).to_hex().to_string())
    }

    /// Where the user's gains are kept: `gains.json` in `$HTEX_CONFIG_DIR`, else in `htex` in the
    /// user's configuration folder. None when there is no such folder.
    pub fn user_file() -> Option<PathBuf> {
        htex_host::folders::config().map(|folder| folder.join("gains.json"))
    }

    /// Reads a file of gains; one that is not there has none.
    ///
    /// # Errors
    /// When it cannot be read, or is something else.
    pub fn load(path: &Path) -> io::Result<Self> {
        let bytes = match fs::metadata(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(error) => return Err(error),
            Ok(found) if found.len() > MAX_BYTES => {
                return Err(io::Error::other("it is too large to be a file of gains"));
            }
            Ok(_) => fs::read(path)?,
        };
        Ok(serde_json::from_slice(&bytes)?)
    }

    /// Reads the file, changes what it holds, and writes it, whole or not at all; programs that do so at once wait for
    /// each other. Its folder is made when it is not there.
    ///
    /// # Errors
    /// As [`Self::load`], and what the system says of writing.
    pub fn update(path: &Path, change: impl FnOnce(&mut Self)) -> io::Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        // Beside it: the file itself is replaced.
        let lock = fs::File::create(path.with_extension("lock"))?;
        lock.lock()?;
        let mut gains = Self::load(path)?;
        change(&mut gains);
        let text = serde_json::to_string_pretty(&gains)? + "\n";
        htex_format::write_file(path, text.as_bytes())
    }

    /// The gain of a key; else one of old, of the same person and device, for the file of this hash.
    pub fn find(&self, key: &GainKey, blake3: &str) -> Option<&Gain> {
        let exact = self.gains.iter().find(|gain| gain.key == *key);
        exact.or_else(|| self.gains.iter().find(|gain| gain.is_of_old(key, blake3)))
    }

    /// Puts a gain in, in place of an earlier one, and of one of old for the file of this hash.
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
