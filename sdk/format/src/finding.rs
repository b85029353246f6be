//! What validation has to say.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How bad a finding is.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
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
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Finding {
    /// Stable name of the rule.
    #[schemars(regex(pattern = "^[A-Z][A-Z0-9_]*$"))]
    pub code: String,
    /// How bad it is.
    pub severity: Severity,
    /// JSON pointer into the manifest; empty for the file as a whole.
    #[schemars(regex(pattern = "^(/([^~/]|~[01])*)*$"))]
    pub pointer: String,
    /// What, where, and what to do.
    pub message: String,
    /// The rule of a JSON Schema that says the same: the schema's file, `#` and a JSON pointer into
    /// it. Only a validator that holds documents to schemas gives it.
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
