//! Findings of recordings grouped by code, for one texture and for all textures of a build.

use std::collections::BTreeMap;

use htex_author::RecordingFinding;
use htex_author::findings::RULES;
use htex_base::finding::Severity;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::report::{Status, TextureReport};

/// Number of texture names in a [`FindingShare`].
const NAMED: usize = 3;
/// Codes that no recording of an asset can have. Findings with the first two codes stop a fit. The
/// last code stands for a sentence of a reader.
const NOT_OF_ASSETS: [&str; 3] = ["RECORDING_UNREADABLE", "RECORDING_UNUSABLE", "RECORDING_NOTED"];

/// All findings with one code in the recordings of one texture.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FindingReport {
    /// Code of the rule (`spec/recording-findings.md`).
    pub code: String,
    /// Severity of the finding.
    pub severity: Severity,
    /// Names of the recordings with this finding.
    pub recordings: Vec<String>,
    /// Message for the first recording in `recordings`.
    pub message: String,
}

/// Number of textures that have a finding with one code. Textures without an asset are not counted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FindingShare {
    /// Severity of the finding.
    pub severity: Severity,
    /// Number of textures with the finding.
    pub textures: usize,
    /// Number of textures with the finding that are in the library.
    pub in_library: usize,
    /// Names of the first three textures with the finding.
    pub first: Vec<String>,
}

/// Groups the findings of a texture by code, in the order of their first occurrence.
pub(crate) fn by_code(findings: &[RecordingFinding]) -> Vec<FindingReport> {
    let mut reports: Vec<FindingReport> = Vec::new();
    for RecordingFinding { recording, finding } in findings {
        match reports.iter_mut().find(|r| r.code == finding.code) {
            Some(report) if report.recordings.last() == Some(recording) => {}
            Some(report) => report.recordings.push(recording.clone()),
            None => reports.push(FindingReport {
                code: finding.code.clone(),
                severity: finding.severity,
                recordings: vec![recording.clone()],
                message: finding.message.clone(),
            }),
        }
    }
    reports
}

/// Counts the textures with a finding, by code.
pub(crate) fn shares(textures: &[TextureReport]) -> BTreeMap<String, FindingShare> {
    let mut shares: BTreeMap<String, FindingShare> = BTreeMap::new();
    for texture in textures {
        let assets = texture.asset.iter();
        for finding in assets.flat_map(|asset| &asset.findings) {
            let share = shares.entry(finding.code.clone()).or_insert_with(|| FindingShare {
                severity: finding.severity,
                textures: 0,
                in_library: 0,
                first: Vec::new(),
            });
            share.textures += 1;
            share.in_library += usize::from(texture.status == Status::Built);
            if share.first.len() < NAMED {
                share.first.push(texture.name.clone());
            }
        }
    }
    shares
}

/// Returns what is wrong with a code that no recording of an asset can have; `None` if the code is
/// possible.
pub(crate) fn unknown_code(code: &str) -> Option<String> {
    let all = RULES.iter().map(|rule| rule.code);
    let known: Vec<&str> = all.filter(|known| !NOT_OF_ASSETS.contains(known)).collect();
    (!known.contains(&code)).then(|| {
        format!("no recording of an asset has a finding {code}; there are {}", known.join(", "))
    })
}
