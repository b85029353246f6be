//! The result of a job and its encoding. The encoding begins with a line of JSON, which contains
//! the record, the lengths of the parts and a hash. The parts (asset and sound) follow this line.

use std::collections::BTreeMap;

use htex_author::FeltError;
use serde::{Deserialize, Serialize};

use crate::BuildError;
use crate::findings::FindingReport;
use crate::thumbnail::Thumbnail;

/// Longest first line, bytes.
const MOST_HEADER: usize = 1 << 20;

/// The result of a job.
#[derive(Debug, Clone, PartialEq)]
pub struct JobResult {
    /// Facts that the asset does not contain.
    pub record: Record,
    /// The asset; empty if there is none.
    pub asset: Vec<u8>,
    /// One second of the texture's sound, a WAV; empty if there is none.
    pub sound: Vec<u8>,
}

/// Results of a fit that are not stored in the asset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub outcome: Outcome,
    /// Number of segments of each condition.
    pub segments: Vec<usize>,
    /// For each model, how much of its difference from the recordings can be felt. Each number is
    /// the worst over all conditions.
    pub felt: BTreeMap<String, FeltError>,
    /// Findings of the recordings, by code.
    pub findings: Vec<FindingReport>,
    /// The recorded spectrum of the first condition. For a texture that was imported without a fit,
    /// this is the spectrum of the default condition.
    pub thumbnail: Thumbnail,
}

/// How a fit ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The texture was fitted or imported, and the result contains its asset.
    Fitted,
    /// With `strict`, the build refused the texture because its recordings have findings.
    NotStrict(String),
    /// A recording, a setting or a model cannot be used.
    Refused(String),
}

#[derive(Serialize, Deserialize)]
struct Header {
    key: String,
    record: Record,
    asset_bytes: usize,
    sound_bytes: usize,
    /// BLAKE3 of key, record and parts.
    blake3: String,
}

impl Header {
    fn hash(&self, asset: &[u8], sound: &[u8]) -> Result<String, serde_json::Error> {
        let mut hasher = blake3::Hasher::new();
        let lengths = (&self.key, &self.record, self.asset_bytes, self.sound_bytes);
        hasher.update(&serde_json::to_vec(&lengths)?);
        hasher.update(asset).update(sound);
        Ok(hasher.finalize().to_hex().to_string())
    }
}

impl JobResult {
    pub(crate) fn refused(outcome: Outcome) -> Self {
        Self {
            record: Record {
                outcome,
                segments: Vec::new(),
                felt: BTreeMap::new(),
                findings: Vec::new(),
                thumbnail: Thumbnail::default(),
            },
            asset: Vec::new(),
            sound: Vec::new(),
        }
    }

    /// Encodes the result for the job with this key.
    ///
    /// # Errors
    /// Returns an error if the record cannot be written as JSON.
    pub fn to_bytes(&self, key: &str) -> Result<Vec<u8>, BuildError> {
        let mut header = Header {
            key: key.to_owned(),
            record: self.record.clone(),
            asset_bytes: self.asset.len(),
            sound_bytes: self.sound.len(),
            blake3: String::new(),
        };
        header.blake3 = header.hash(&self.asset, &self.sound)?;
        let mut bytes = serde_json::to_vec(&header)?;
        bytes.push(b'\n');
        bytes.extend_from_slice(&self.asset);
        bytes.extend_from_slice(&self.sound);
        Ok(bytes)
    }

    /// Decodes the result of the job with this key.
    ///
    /// # Errors
    /// Returns an error if the bytes are the result of another job, or if any bit has changed.
    pub fn from_bytes(key: &str, bytes: &[u8]) -> Result<Self, BuildError> {
        let damaged = |problem: &str| BuildError::Damaged(problem.to_owned());
        let line = bytes.iter().take(MOST_HEADER).position(|b| *b == b'\n');
        let line = line.ok_or_else(|| damaged("it has no first line"))?;
        let header: Header = serde_json::from_slice(&bytes[..line])
            .map_err(|error| damaged(&format!("its first line: {error}")))?;
        if header.key != key {
            return Err(damaged("it belongs to another job"));
        }
        let parts = &bytes[line + 1..];
        // The lengths come from the file, so their sum may overflow.
        let length = header.asset_bytes.checked_add(header.sound_bytes);
        if length != Some(parts.len()) {
            return Err(damaged("it is too short or too long"));
        }
        let (asset, sound) = parts.split_at(header.asset_bytes);
        if header.hash(asset, sound).ok().as_deref() != Some(&header.blake3) {
            return Err(damaged("its hash differs"));
        }
        Ok(Self { record: header.record, asset: asset.to_vec(), sound: sound.to_vec() })
    }
}
