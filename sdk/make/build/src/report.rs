//! The report of a build: `build-report.json`. It contains no times and no folders, so equal builds
//! have equal reports, except for the textures that this build removed.

use std::collections::BTreeMap;

use htex_author::{FeltError, FeltShare};
use htex_format::{Asset, Measure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::findings::{FindingReport, FindingShare};
use crate::job::Job;
use crate::job_result::{JobResult, Outcome};
use crate::recipe::Recipe;
use crate::thumbnail::Thumbnail;

/// Name and version of the report's format.
pub const REPORT: &str = "htex-build-report/1";

/// The report of a build.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// `htex-build-report/1`.
    pub report: String,
    /// Program and version that built.
    pub program: String,
    /// The error that ended the build, line by line. All other fields then describe what an earlier
    /// build left, if there was one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub error: Vec<String>,
    /// The library.
    pub library: LibraryReport,
    /// Names of textures that are in the library before this build but no longer in the recipe.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub removed: Vec<String>,
    /// By model id, how many textures of the library differ from their recordings by less than the
    /// difference threshold at all their conditions, and how many by less than their recordings
    /// vary.
    pub felt_shares: BTreeMap<String, FeltShare>,
    /// By code of a finding of recordings: the textures with this finding.
    pub findings: BTreeMap<String, FindingShare>,
    /// All textures of the recipe, by name.
    pub textures: Vec<TextureReport>,
}

/// The library of a build.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LibraryReport {
    /// Its name.
    pub name: String,
    /// Its file, relative to the folder of the report.
    pub file: String,
    /// Its size, bytes.
    pub bytes: u64,
    /// BLAKE3 of its index, hexadecimal. The index contains the hashes of all textures.
    pub blake3: String,
    /// Number of textures in it.
    pub textures: usize,
    /// Number of textures that were left out.
    pub left_out: usize,
}

/// A texture of a build.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TextureReport {
    /// Its name.
    pub name: String,
    /// Whether it is in the library.
    pub status: Status,
    /// Hash of everything that its bytes depend on.
    pub key: String,
    /// Its recordings.
    pub recordings: Vec<RecordingReport>,
    /// Why it was left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missed: Vec<MissedGate>,
    /// Its asset, even if it was left out because of a gate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asset: Option<AssetReport>,
}

/// Whether a texture is in the library.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It is in the library.
    Built,
    /// It misses a gate, or could not be fitted.
    LeftOut,
}

/// A recording of a texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RecordingReport {
    /// File name without its folder.
    pub file: String,
    /// Its size, bytes.
    pub bytes: u64,
    /// BLAKE3 of its contents, hexadecimal.
    pub blake3: String,
}

/// A gate that a texture misses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MissedGate {
    /// The key of the gate in the recipe, or `fit` if there is no asset.
    pub gate: String,
    /// What is wrong, as a sentence.
    pub reason: String,
}

/// The asset of a texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AssetReport {
    /// Its size, bytes.
    pub bytes: u64,
    /// BLAKE3 of the asset, hexadecimal.
    pub blake3: String,
    /// SPDX licence expression.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub license: Option<String>,
    /// Who made it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// Search terms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// Whether a recording comes from a simulator.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
    /// Number of conditions.
    pub conditions: usize,
    /// Smallest and largest speed of the conditions, mm/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_mm_s: Option<[f64; 2]>,
    /// Smallest and largest normal force of the conditions, newtons.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_n: Option<[f64; 2]>,
    /// Smallest number of segments of a condition; 0 for a texture that a file of another format
    /// states.
    pub segments: usize,
    /// Largest repeatability value of a condition, to compare errors with, decibels: the RMS over
    /// nine bands of the difference between odd and even blocks of time, over √2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeatability_rms_db: Option<f64>,
    /// Largest nine-band RMS error of each model over its conditions, decibels, by model id.
    pub band_error_rms_db: BTreeMap<String, f64>,
    /// How much of the difference from the recordings is felt, for each model at its worst
    /// condition, by model id.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub felt: BTreeMap<String, FeltError>,
    /// Findings of its recordings, by code.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<FindingReport>,
    /// Warnings of the fit, including those from findings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The recorded spectrum of the first condition, or, for a texture that a file states, the
    /// spectrum of its default condition. It has 48 points evenly spaced in log frequency. 63 is
    /// the largest magnitude, 0 is 40 dB below it or less.
    #[schemars(with = "Vec<u8>")]
    pub spectrum: Thumbnail,
}

impl TextureReport {
    /// Reports a texture with its asset, if it has one.
    pub(crate) fn new(job: &Job, key: &str, made: &JobResult, asset: Option<&Asset>) -> Self {
        let recordings = job.recordings.iter().map(|recording| RecordingReport {
            file: recording.name.clone(),
            bytes: recording.file.hash.stamp.bytes,
            blake3: recording.file.hash.blake3.clone(),
        });
        Self {
            name: job.texture.clone(),
            status: Status::Built,
            key: key.to_owned(),
            recordings: recordings.collect(),
            missed: match &made.record.outcome {
                Outcome::Fitted => Vec::new(),
                Outcome::NotStrict(reason) => vec![MissedGate::new("strict", reason)],
                Outcome::Refused(reason) => vec![MissedGate::new("fit", reason)],
            },
            asset: asset.map(|asset| AssetReport::new(made, asset)),
        }
    }
}

impl MissedGate {
    pub(crate) fn new(gate: &str, reason: impl Into<String>) -> Self {
        Self { gate: gate.to_owned(), reason: reason.into() }
    }
}

impl AssetReport {
    fn new(made: &JobResult, asset: &Asset) -> Self {
        let manifest = &asset.manifest;
        let conditions = || manifest.conditions.iter();
        // A representation that a file of another format states has no error.
        let errors = manifest.representations.iter().filter_map(|representation| {
            let qualities = representation.at.iter().filter_map(|at| at.quality.as_ref());
            let errors = qualities.filter_map(|q| q.get(Measure::NineBand));
            let worst = errors.reduce(f64::max)?;
            Some((representation.model.clone(), worst))
        });
        Self {
            bytes: made.asset.len() as u64,
            blake3: blake3::hash(&made.asset).to_hex().to_string(),
            license: manifest.license.clone(),
            author: manifest.author.clone(),
            tags: manifest.tags.clone(),
            simulated: manifest.provenance.simulated,
            conditions: manifest.conditions.len(),
            speed_mm_s: range(conditions().filter_map(|c| c.speed_mm_s)),
            force_n: range(conditions().filter_map(|c| c.force_n)),
            segments: made.record.segments.iter().copied().min().unwrap_or(0),
            repeatability_rms_db: conditions()
                .filter_map(|c| c.repeatability_rms_db)
                .reduce(f64::max),
            band_error_rms_db: errors.collect(),
            felt: made.record.felt.clone(),
            findings: made.record.findings.clone(),
            warnings: manifest.provenance.warnings.clone(),
            spectrum: made.record.thumbnail.clone(),
        }
    }
}

impl AssetReport {
    /// Returns whether it has a warning that does not come from a finding of a recording.
    pub fn has_other_warnings(&self) -> bool {
        let is_finding = |warning: &String| self.findings.iter().any(|f| warning.contains(&f.code));
        self.warnings.iter().any(|warning| !is_finding(warning))
    }
}

/// Counts, by model, the textures whose difference is below the difference threshold, and the
/// textures whose difference is within the variation of their recordings.
pub(crate) fn felt_shares(textures: &[TextureReport]) -> BTreeMap<String, FeltShare> {
    let mut shares: BTreeMap<String, FeltShare> = BTreeMap::new();
    let built = textures.iter().filter(|t| t.status == Status::Built);
    for asset in built.filter_map(|texture| texture.asset.as_ref()) {
        for (model, felt) in &asset.felt {
            shares.entry(model.clone()).or_default().count(felt);
        }
    }
    shares
}

fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.fold(None, |range, value| match range {
        None => Some([value, value]),
        Some([low, high]) => Some([f64::min(low, value), f64::max(high, value)]),
    })
}

/// Returns the JSON Schema of [`Report`]: `spec/schemas/build-report-1.json`.
pub fn report_schema() -> serde_json::Value {
    htex_base::schema::document::<Report>("build-report-1.json", "report of the build of a library")
}

/// Returns the JSON Schema of [`Recipe`], for editors that check TOML:
/// `spec/schemas/recipe-1.json`.
pub fn recipe_schema() -> serde_json::Value {
    htex_base::schema::document::<Recipe>("recipe-1.json", "recipe of a library of textures")
}
