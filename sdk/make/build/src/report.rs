//! The report of a build: `build-report.json`. The report contains no times and no folders, so
//! equal builds have equal reports. The exceptions are the lists of removed and kept textures,
//! which also depend on the earlier build.

use std::collections::BTreeMap;

use htex_author::{FeltError, FeltShare};
use htex_format::{Asset, HeldOut, Measure};
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
    /// Program and version that made the build.
    pub program: String,
    /// The error that ended the build, line by line; empty if the build succeeded. After an error,
    /// all other fields come from the report of the earlier build, if there is one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub error: Vec<String>,
    /// The library that the build made.
    pub library: LibraryReport,
    /// Names of textures that were in the library before this build but are no longer in the
    /// recipe.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub removed: Vec<String>,
    /// Names of textures that stay unchanged in the library: an earlier build made them, but the
    /// recipe no longer makes them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub kept: Vec<String>,
    /// For each model (by id), counts of textures in the library. `below_difference_threshold`
    /// counts textures whose difference from the recordings is below the difference threshold at
    /// all conditions. `within_repeatability` counts textures whose difference is within the
    /// variation of their recordings.
    pub felt_shares: BTreeMap<String, FeltShare>,
    /// For each code of a finding, the textures with this finding.
    pub findings: BTreeMap<String, FindingShare>,
    /// All textures of the recipe, by name.
    pub textures: Vec<TextureReport>,
}

/// The library that the build made.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LibraryReport {
    /// Name of the library.
    pub name: String,
    /// File of the library, relative to the folder of the report.
    pub file: String,
    /// Size of the library's file, bytes.
    pub bytes: u64,
    /// BLAKE3 hash of the library's index, hexadecimal. The index contains the hashes of all
    /// textures.
    pub blake3: String,
    /// Number of textures in the library.
    pub textures: usize,
    /// Number of textures that were left out of the library.
    pub left_out: usize,
}

/// A texture of a build.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TextureReport {
    /// Name of the texture.
    pub name: String,
    /// Whether the texture is in the library.
    pub status: Status,
    /// Hash of everything that the texture's bytes depend on.
    pub key: String,
    /// Recordings of the texture.
    pub recordings: Vec<RecordingReport>,
    /// Why the texture was left out of the library.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missed: Vec<MissedGate>,
    /// The texture's asset, even if a gate kept it out of the library.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asset: Option<AssetReport>,
}

/// Whether a texture is in the library.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The texture is in the library.
    Built,
    /// The texture does not meet the requirement of a gate, or could not be fitted.
    LeftOut,
}

/// A recording of a texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RecordingReport {
    /// File name without its folder.
    pub file: String,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// BLAKE3 hash of the file's contents, hexadecimal.
    pub blake3: String,
}

/// A gate whose requirement a texture does not meet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MissedGate {
    /// The key of the gate in the recipe, or `fit` if the texture could not be fitted.
    pub gate: String,
    /// What is wrong, as a sentence.
    pub reason: String,
}

/// The asset of a texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AssetReport {
    /// Size of the asset, bytes.
    pub bytes: u64,
    /// BLAKE3 hash of the asset, hexadecimal.
    pub blake3: String,
    /// SPDX licence expression.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub license: Option<String>,
    /// Who made the texture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// Search terms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    /// Whether any recording of the texture comes from a simulator.
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
    /// Smallest number of segments over all conditions; 0 for a texture that was imported without a
    /// fit.
    pub segments: usize,
    /// Largest repeatability value over all conditions, decibels. This value is the RMS difference
    /// between odd and even blocks of time, over nine bands, divided by √2. Errors near or below
    /// this value are within the recordings' own variation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeatability_rms_db: Option<f64>,
    /// Held-out error at the condition where it is largest, for each model (by id).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub held_out: BTreeMap<String, HeldOut>,
    /// Largest nine-band RMS error over all conditions, decibels, for each model (by id).
    pub band_error_rms_db: BTreeMap<String, f64>,
    /// For each model (by id), how much of its difference from the recordings can be felt. Each
    /// number is the worst value over all conditions.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub felt: BTreeMap<String, FeltError>,
    /// Findings about the texture's recordings, grouped by code.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<FindingReport>,
    /// Warnings of the fit, including warnings that come from findings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The recorded spectrum of the first condition. For a texture that was imported without a fit,
    /// this is the spectrum of the default condition. The spectrum has 48 points evenly spaced in
    /// log frequency. The value 63 stands for the largest magnitude. The value 0 stands for all
    /// magnitudes that are at least 40 dB below the largest.
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
        let conditions = || manifest.conditions.iter().filter(|c| c.is_recorded());
        // A representation that was imported from a file of another format has no error.
        let errors = manifest.representations.iter().filter_map(|representation| {
            let qualities = representation.at.iter().filter_map(|at| at.quality.as_ref());
            let errors = qualities.filter_map(|q| q.get(Measure::NineBand));
            let worst = errors.reduce(f64::max)?;
            Some((representation.model.clone(), worst))
        });
        let held_out = manifest.representations.iter().filter_map(|representation| {
            let at = representation.at.iter();
            let all = at.filter_map(|at| manifest.held_out(at));
            let worst = all.max_by(|a, b| a.held_out_error_db.total_cmp(&b.held_out_error_db))?;
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
            held_out: held_out.collect(),
            band_error_rms_db: errors.collect(),
            felt: made.record.felt.clone(),
            findings: made.record.findings.clone(),
            warnings: manifest.provenance.warnings.clone(),
            spectrum: made.record.thumbnail.clone(),
        }
    }
}

impl AssetReport {
    /// Returns whether the asset has a warning that does not come from a finding of a recording.
    pub fn has_other_warnings(&self) -> bool {
        let is_finding = |warning: &String| self.findings.iter().any(|f| warning.contains(&f.code));
        self.warnings.iter().any(|warning| !is_finding(warning))
    }
}

/// Counts the textures for each model: those whose difference is below the difference threshold,
/// and those whose difference is within the variation of their recordings.
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
