//! Findings of checks.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// How a check ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// The guarantee holds.
    Passed,
    /// The guarantee holds, but something needs attention.
    Warning,
    /// The check does not apply, or it needs another check that did not pass.
    Skipped,
    /// The guarantee is violated.
    Failed,
    /// The process that ran the check died.
    Crashed,
    /// The check exceeded its time limit.
    TimedOut,
}

impl Outcome {
    /// All outcomes, in the order in which reports list their counts.
    pub const ALL: [Self; 6] =
        [Self::Passed, Self::Warning, Self::Skipped, Self::Failed, Self::Crashed, Self::TimedOut];

    /// Returns whether this outcome means that the checked model or device is at fault.
    pub fn is_bad(self) -> bool {
        matches!(self, Self::Failed | Self::Crashed | Self::TimedOut)
    }

    /// Returns the name of the outcome in the JSON report.
    pub fn word(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Warning => "warning",
            Self::Skipped => "skipped",
            Self::Failed => "failed",
            Self::Crashed => "crashed",
            Self::TimedOut => "timed-out",
        }
    }
}

/// The finding of a check: an outcome, a sentence, and measured numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    pub outcome: Outcome,
    pub message: String,
    /// Measured numbers by name. Each name ends with the unit.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub numbers: BTreeMap<String, f64>,
}

/// The result of a check. `Ok` and `Err` both contain a finding, so a check can end early with `?`.
pub type CheckResult = Result<Finding, Finding>;

impl Finding {
    /// Creates a finding without numbers.
    pub fn new(outcome: Outcome, message: impl Into<String>) -> Self {
        Self { outcome, message: message.into(), numbers: BTreeMap::new() }
    }

    /// Creates a finding which states that the guarantee holds.
    pub fn passed(message: impl Into<String>) -> Self {
        Self::new(Outcome::Passed, message)
    }

    /// Creates a finding which states that the guarantee holds, but that something needs attention.
    pub fn warning(message: impl Into<String>) -> Self {
        Self::new(Outcome::Warning, message)
    }

    /// Creates a finding which states that the check does not apply.
    pub fn skipped(message: impl Into<String>) -> Self {
        Self::new(Outcome::Skipped, message)
    }

    /// Creates a finding which states that the guarantee is violated.
    pub fn failed(message: impl Into<String>) -> Self {
        Self::new(Outcome::Failed, message)
    }

    /// Adds a measured number. NaN and infinities are left out, because JSON cannot represent them.
    pub fn with(mut self, name: &str, value: f64) -> Self {
        if value.is_finite() {
            self.numbers.insert(name.to_owned(), value);
        }
        self
    }
}

/// An error of the model or device fails the check.
impl<E: std::error::Error> From<E> for Finding {
    fn from(error: E) -> Self {
        Self::failed(error.to_string())
    }
}
