//! Findings of validation.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Severity of a finding.
///
/// ```
/// use htex_format::Severity;
/// assert!(Severity::Error < Severity::Info);
/// assert_eq!(Severity::Warning.to_string(), "warning");
/// ```
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The asset cannot be used.
    Error,
    /// The asset can be used, but probably contains a mistake.
    Warning,
    /// Information that needs no action.
    Info,
}

/// A finding of validation.
///
/// ```
/// use htex_format::{Limits, validate};
/// let report = validate(b"not an asset", &Limits::default());
/// for finding in &report.findings {
///     println!("{} {finding}", finding.severity);
/// }
/// assert!(!report.valid);
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Finding {
    /// Stable code of the rule.
    #[schemars(regex(pattern = "^[A-Z][A-Z0-9_]*$"))]
    pub code: String,
    /// Severity.
    pub severity: Severity,
    /// JSON pointer into the manifest; empty for the file as a whole.
    #[schemars(regex(pattern = "^(/([^~/]|~[01])*)*$"))]
    pub pointer: String,
    /// What is wrong, where, and what to do.
    pub message: String,
    /// The keyword of a JSON Schema that the document breaks: the schema's file, `#` and a JSON pointer into
    /// it. Only validators that check documents against schemas set it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(regex(pattern = "#"))]
    pub schema_rule: Option<String>,
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
                let pointer = crate::plain(pointer);
                write!(f, "{} at {pointer}: {}", self.code, self.message)
            }
        }
    }
}
