//! How strong a drive each person wants to feel a surface on a device: V_g of the paper, found by
//! adjustment, kept in a file of the user's own.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// Largest file that is read, bytes.
const MAX_BYTES: u64 = 16 << 20;

/// What a gain is for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct GainKey {
    /// Who feels it.
    pub person: String,
    /// BLAKE3 hash of the asset or scene, hexadecimal.
    pub blake3: String,
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
}

/// The gains in a file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Gains {
    /// All of them, each key once.
    pub gains: Vec<Gain>,
}

impl GainKey {
    /// The key of the asset or scene in `file`.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn new(person: &str, file: &Path, device: &str, profile: Option<&str>) -> io::Result<Self> {
        Ok(Self {
            person: person.to_owned(),
            blake3: blake3::hash(&fs::read(file)?).to_hex().to_string(),
            device: device.to_owned(),
            profile: profile.unwrap_or_default().to_owned(),
        })
    }
}

impl Gains {
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

    /// Writes the file, whole or not at all; its folder is made when it is not there.
    ///
    /// # Errors
    /// What the system says.
    pub fn save(&self, path: &Path) -> io::Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        let text = serde_json::to_string_pretty(self)? + "\n";
        htex_format::write_file(path, text.as_bytes())
    }

    /// The gain of a key.
    pub fn find(&self, key: &GainKey) -> Option<&Gain> {
        self.gains.iter().find(|gain| gain.key == *key)
    }

    /// Puts a gain in, in place of an earlier one.
    pub fn put(&mut self, gain: Gain) {
        self.gains.retain(|other| other.key != gain.key);
        self.gains.push(gain);
    }
}
