//! Reports of all checks of one model or device.

use std::fmt::{self, Display};

use serde::Serialize;

use crate::harness::{Finding, Outcome};

/// One check and its finding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckReport {
    pub check: &'static str,
    #[serde(flatten)]
    pub finding: Finding,
}

/// The results of all checks of a model or a device. The type `Subject` identifies the model or
/// device, and the settings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report<Subject> {
    /// The model or device. In JSON, the subject's fields are at the same level as `ok`.
    #[serde(flatten)]
    pub subject: Subject,
    /// True if no check failed, crashed or timed out.
    pub ok: bool,
    /// The result of each check, in the order of the table.
    pub checks: Vec<CheckReport>,
}

impl<Subject> Report<Subject> {
    pub fn new(subject: Subject, checks: Vec<CheckReport>) -> Self {
        let ok = !checks.iter().any(|check| check.finding.outcome.is_bad());
        Self { subject, ok, checks }
    }

    /// Returns the names of the checks that failed, crashed or timed out.
    pub fn bad(&self) -> Vec<&'static str> {
        let bad = self.checks.iter().filter(|c| c.finding.outcome.is_bad());
        bad.map(|check| check.check).collect()
    }

    /// Returns the number of checks with this outcome.
    pub fn count(&self, outcome: Outcome) -> usize {
        let same = self.checks.iter().filter(|c| c.finding.outcome == outcome);
        same.count()
    }
}

/// Prints one line for the subject, one for each check, and one with the counts.
impl<Subject: Display> Display for Report<Subject> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.subject)?;
        for CheckReport { check, finding } in &self.checks {
            let word = match finding.outcome {
                bad if bad.is_bad() => bad.word().to_uppercase(),
                other => other.word().to_owned(),
            };
            writeln!(f, "  {word:9}  {check:15}  {}", finding.message)?;
        }
        let counts = Outcome::ALL
            .map(|outcome| (self.count(outcome), outcome.word()))
            .into_iter()
            .filter(|(n, _)| *n > 0);
        let counts: Vec<String> = counts.map(|(n, word)| format!("{n} {word}")).collect();
        writeln!(f, "{}", counts.join(", "))
    }
}
