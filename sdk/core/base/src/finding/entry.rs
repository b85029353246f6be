//! Findings of validation.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::finding::{Hint, Rule, plain};

/// Severity of a finding.
///
/// ```
/// use htex_base::finding::Severity;
/// assert!(Severity::Error < Severity::Info);
/// assert_eq!(Severity::Warning.to_string(), "warning");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The file cannot be used.
    Error,
    /// The file can be used, but probably contains a mistake.
    Warning,
    /// Information that needs no action.
    Info,
}

/// A problem or note that validation found.
///
/// ```
/// use htex_base::finding::{FINDINGS_TRUNCATED, Finding};
/// let finding = Finding::new(FINDINGS_TRUNCATED, "", "2 more findings are not shown");
/// assert_eq!(finding.to_string(), "FINDINGS_TRUNCATED: 2 more findings are not shown");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Finding {
    /// Stable code of the broken rule.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = "^[A-Z][A-Z0-9_]*$")))]
    pub code: String,
    /// Severity.
    pub severity: Severity,
    /// JSON pointer to the place in the document (for an asset, in its manifest). The pointer is
    /// empty if the finding concerns the whole file.
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = "^(/([^~/]|~[01])*)*$")))]
    pub pointer: String,
    /// The problem, its place, and what to do about it.
    pub message: String,
    /// The JSON Schema keyword that the document violates, written as the name of the schema's
    /// file, `#`, and a JSON pointer into the schema. Only validators that check documents against
    /// JSON Schemas set this field.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = "#")))]
    pub schema_rule: Option<String>,
    /// The settings that would fix the problem. A finding that is read from JSON has no hint.
    #[serde(skip)]
    pub hint: Hint,
}

impl Finding {
    /// Creates a finding for a rule. Control characters in the message are escaped.
    pub fn new(rule: &Rule, pointer: impl Into<String>, message: &str) -> Self {
        Self {
            code: rule.code.to_owned(),
            severity: rule.severity,
            pointer: pointer.into(),
            message: plain(message).into_owned(),
            schema_rule: None,
            hint: rule.hint,
        }
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Info => "info",
        })
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.pointer.as_str() {
            "" => write!(f, "{}: {}", self.code, self.message),
            pointer => {
                let pointer = plain(pointer);
                write!(f, "{} at {pointer}: {}", self.code, self.message)
            }
        }
    }
}

/// Number of findings shown in the text of an error.
const SHOWN: usize = 3;

/// Formats the first errors in a list as one line.
pub fn summary(findings: &[Finding]) -> String {
    let errors = || findings.iter().filter(|f| f.severity == Severity::Error);
    let mut text: Vec<String> = errors().take(SHOWN).map(ToString::to_string).collect();
    let rest = errors().count().saturating_sub(SHOWN);
    if rest > 0 {
        text.push(format!("and {rest} more"));
    }
    text.join("; ")
}

/// Formats findings for the end of a message, one per line.
pub fn listed(findings: &[Finding]) -> String {
    let line = |f: &Finding| format!("\n  {} {}", f.severity, plain(&f.to_string()));
    findings.iter().map(line).collect()
}
