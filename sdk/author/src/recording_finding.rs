//! Findings of an asset's recordings, each with the recording's name.

use htex_base::finding::Finding;

/// A finding of one of several recordings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordingFinding {
    /// The recording's name, as in its warnings.
    pub recording: String,
    pub finding: Finding,
}

impl RecordingFinding {
    /// The findings of one recording, in their order.
    pub(crate) fn all(recording: &str, findings: Vec<Finding>) -> impl Iterator<Item = Self> {
        findings.into_iter().map(move |finding| Self { recording: recording.to_owned(), finding })
    }
}
