//! What validation has to say.

use serde::{Deserialize, Serialize};

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The asset cannot be used.
    Error,
    /// It can, but something is probably not as meant.
    Warning,
    /// Worth knowing.
    Info,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Finding {
    /// Stable name of the rule.
    pub code: String,
    /// How bad it is.
    pub severity: Severity,
    /// JSON pointer into the manifest; empty for the file as a whole.
    pub pointer: String,
    /// What, where, and what to do.
    pub message: String,
}
