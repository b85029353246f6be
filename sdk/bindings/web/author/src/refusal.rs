//! Errors of calls. An error has libhtex's status, a more specific code, and a text.

use htex::model::HostError;
use htex_c::calls::Failure;
use htex_c::htex_status::{self, *};
use serde::Serialize;

/// The error of a call.
#[derive(Debug)]
pub(crate) struct Refusal {
    status: htex_status,
    message: String,
    /// The document that the caller receives.
    json: Vec<u8>,
}

/// The document of an error.
#[derive(Serialize)]
struct ErrorDocument<'a> {
    code: &'a str,
    message: &'a str,
}

impl Refusal {
    pub(crate) fn new(status: htex_status, code: &str, error: impl ToString) -> Self {
        let message = error.to_string();
        let told = ErrorDocument { code, message: &message };
        Self { status, json: serde_json::to_vec(&told).unwrap_or_default(), message }
    }

    /// An argument or a setting is invalid.
    pub(crate) fn argument(error: impl ToString) -> Self {
        Self::new(HTEX_STATUS_INVALID_ARGUMENT, "invalid-argument", error)
    }

    pub(crate) fn model(error: impl ToString) -> Self {
        Self::new(HTEX_STATUS_MODEL, "model", error)
    }

    pub(crate) fn internal(error: impl ToString) -> Self {
        Self::new(HTEX_STATUS_INTERNAL, "internal", error)
    }

    pub(crate) fn json(&self) -> &[u8] {
        &self.json
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Self {
        Self::new(refusal.status, refusal.message)
    }
}

impl From<HostError> for Refusal {
    fn from(error: HostError) -> Self {
        match error {
            HostError::UnknownOption { .. } | HostError::OptionValue { .. } => {
                Self::argument(error)
            }
            HostError::Call { .. } | HostError::Broken { .. } => Self::model(error),
            other => Self::new(HTEX_STATUS_NO_MODEL, "no-model", other),
        }
    }
}
