//! Reports of validation.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::finding::{FINDINGS_TRUNCATED, Finding, Notice, Rule, Severity};

/// Largest number of findings in a report. A hostile file could cause millions.
const KEPT: usize = 100;

/// The result of a validation: whether the file is valid, and the findings.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    /// Whether the file can be used. This is the case if no finding is an error.
    pub valid: bool,
    /// All findings, in the order in which the file is read.
    pub findings: Vec<Finding>,
}

/// The result of validating a file, in the JSON form that `htex validate` and the conformance
/// reports write. Its schema is `spec/schemas/report-1.json`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct FileReport {
    /// Name of the file.
    pub file: String,
    /// Whether the file can be used. This is the case if no finding is an error.
    pub valid: bool,
    /// All findings, in the order in which the file is read.
    pub findings: Vec<Finding>,
    /// Names and values of the reading limits that differ from their defaults.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub limits: BTreeMap<String, u64>,
}

impl Report {
    /// Creates a report from findings. The file counts as valid if no finding is an error.
    pub fn new(findings: Vec<Finding>) -> Self {
        let is_error = |finding: &Finding| finding.severity == Severity::Error;
        Self { valid: !findings.iter().any(is_error), findings }
    }

    /// Adds the name of the file.
    pub fn of_file(self, file: &str) -> FileReport {
        FileReport {
            file: file.to_owned(),
            valid: self.valid,
            findings: self.findings,
            limits: BTreeMap::new(),
        }
    }
}

/// Collects findings and keeps the first hundred.
///
/// ```
/// use htex_base::finding::{FINDINGS_TRUNCATED, Findings};
///
/// let mut findings = Findings::default();
/// findings.add(FINDINGS_TRUNCATED, "", "2 more findings are not shown".to_owned());
/// assert!(!findings.has_errors());
/// assert_eq!(findings.into_list().len(), 1);
/// ```
#[derive(Debug, Default)]
pub struct Findings {
    kept: Vec<Finding>,
    dropped: usize,
    errors: bool,
}

impl Findings {
    /// Adds a finding: the broken rule, a JSON pointer (empty for the whole document), and a
    /// message that says what is wrong, where, and what to do.
    pub fn add(&mut self, rule: &Rule, pointer: impl Into<String>, message: impl Into<Notice>) {
        // The severity is recorded before the limit is checked, because an error may come after a
        // hundred warnings.
        self.errors |= rule.severity == Severity::Error;
        if self.kept.len() < KEPT {
            let Notice { text, hint } = message.into();
            let finding = Finding::new(rule, pointer, &text);
            self.kept.push(Finding { hint: finding.hint.or(hint), ..finding });
        } else {
            self.dropped += 1;
        }
    }

    /// Adds the finding if `holds` is false. The pointer and the message are formatted only in this
    /// case.
    pub fn require(
        &mut self,
        holds: bool,
        rule: &Rule,
        pointer: impl std::fmt::Display,
        message: impl FnOnce() -> String,
    ) {
        if !holds {
            self.add(rule, pointer.to_string(), message());
        }
    }

    pub fn has_errors(&self) -> bool {
        self.errors
    }

    /// Returns the findings. If there were more than a hundred findings, an additional last finding
    /// states how many were dropped.
    pub fn into_list(mut self) -> Vec<Finding> {
        if self.dropped > 0 {
            let message = format!("{} more findings are not shown", self.dropped);
            self.kept.push(Finding::new(FINDINGS_TRUNCATED, "", &message));
        }
        self.kept
    }
    pub fn into_report(self) -> Report {
        Report::new(self.into_list())
    }
}
