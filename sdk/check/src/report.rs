//! What all checks found.

use std::fmt::Write;

use serde::Serialize;

use crate::{Finding, Outcome};

/// One check and what it found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckReport {
    /// The check's name.
    pub check: &'static str,
    /// What it found.
    #[serde(flatten)]
    pub finding: Finding,
}

/// All checks of one file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The model file.
    pub file: String,
    /// The seed that the checks were given.
    pub seed: u64,
    /// Whether no check failed, crashed or timed out.
    pub ok: bool,
    /// Each check, in the order of the table.
    pub checks: Vec<CheckReport>,
}

impl Report {
    pub(crate) fn new(file: String, seed: u64, checks: Vec<CheckReport>) -> Self {
        let ok = !checks.iter().any(|check| check.finding.outcome.is_bad());
        Self {
            file,
            seed,
            ok,
            checks,
        }
    }

    /// Names of the checks that failed, crashed or timed out.
    pub fn bad(&self) -> Vec<&'static str> {
        let bad = self.checks.iter().filter(|c| c.finding.outcome.is_bad());
        bad.map(|check| check.check).collect()
    }

    /// How many checks ended so.
    pub fn count(&self, outcome: Outcome) -> usize {
        count(&self.checks, outcome)
    }

    /// The report as a person reads it.
    pub fn to_text(&self) -> String {
        let mut text = format!(
            "{} (seed {})\n{}",
            self.file,
            self.seed,
            lines(&self.checks)
        );
        if let Some(first) = self.bad().first() {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "again, in one process: htex plugin check {} --reproduce {first} --seed {}",
                self.file, self.seed
            );
        }
        text
    }
}

fn count(checks: &[CheckReport], outcome: Outcome) -> usize {
    let same = checks.iter().filter(|c| c.finding.outcome == outcome);
    same.count()
}

/// A line for each check, and one that counts them.
pub fn lines(checks: &[CheckReport]) -> String {
    let mut text = String::new();
    for CheckReport { check, finding } in checks {
        let word = match finding.outcome {
            bad if bad.is_bad() => bad.word().to_uppercase(),
            other => other.word().to_owned(),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {word:9}  {check:15}  {}", finding.message);
    }
    let counts = [
        Outcome::Passed,
        Outcome::Warning,
        Outcome::Skipped,
        Outcome::Failed,
        Outcome::Crashed,
        Outcome::TimedOut,
    ];
    let counts = counts.map(|outcome| (count(checks, outcome), outcome.word()));
    let counts = counts.iter().filter(|(n, _)| *n > 0);
    let counts: Vec<String> = counts.map(|(n, word)| format!("{n} {word}")).collect();
    text + &counts.join(", ") + "\n"
}
