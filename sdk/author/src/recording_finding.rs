//! Findings of the recordings of an asset, each with its recording.

use htex_finding::Finding;

/// A finding of one of several recordings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordingFinding {
    /// The recording, as its warnings name it.
    pub recording: String,
    pub finding: Finding,
}

impl RecordingFinding {
    /// The findings of one recording, in their order.
    pub(crate) fn all(recording: &str, findings: Vec<Finding>) -> impl Iterator<Item = Self> {
        findings.into_iter().map(move |finding| Self { recording: recording.to_owned(), finding })
    }
}
