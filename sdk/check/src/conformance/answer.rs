//! The JSON object that a reader prints.

use serde::Deserialize;
use serde_json::Value;

use super::process::shortened;

/// What a reader says about a file.
#[derive(Debug, Deserialize)]
pub(super) struct Answer {
    pub(super) verdict: Verdict,
    /// Absent if the program is no validator.
    pub(super) findings: Option<Vec<Found>>,
    /// Absent if the program is no player.
    pub(super) values: Option<Value>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Verdict {
    Valid,
    Invalid,
}

impl Verdict {
    pub(super) fn of(is_valid: bool) -> Self {
        if is_valid { Self::Valid } else { Self::Invalid }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Valid => "valid",
            Self::Invalid => "invalid",
        }
    }
}

/// A finding, without its severity and message.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(super) struct Found {
    pub(super) code: String,
    pub(super) pointer: String,
}

impl std::fmt::Display for Found {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.pointer[..] {
            "" => f.write_str(&self.code),
            pointer => write!(f, "{} at {pointer}", self.code),
        }
    }
}

impl Answer {
    /// Parses the output of a reader. After an error, returns a sentence about the problem.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, String> {
        let text = std::str::from_utf8(bytes).map_err(|_| "it printed no UTF-8".to_owned())?;
        if text.trim().is_empty() {
            return Err("it printed nothing".to_owned());
        }
        // The text is first parsed as any JSON, to distinguish text that is not JSON from an object
        // with other keys.
        let value: Value = serde_json::from_str(text).map_err(|error| {
            let start = shortened(text);
            format!("it printed no JSON object ({error}): {start}")
        })?;
        if !value.is_object() {
            return Err(format!("it printed no JSON object: {}", shortened(text)));
        }
        serde_json::from_value(value).map_err(|error| format!("its answer is wrong: {error}"))
    }
}
