//! Checks SPDX licence expressions.

mod expression;

use crate::rules as rule;
use htex_base::finding::Rule;

/// The error for a text that is not an SPDX expression of listed licences.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LicenseError {
    /// The id of a licence is not in the SPDX list. It may be newer than this program's copy of the
    /// list.
    #[error(
        "{id:?} is not in the SPDX list; correct it, or write LicenseRef-NAME for a licence of your own"
    )]
    Unlisted { id: String },
    /// The text breaks the grammar of SPDX expressions.
    #[error("{license:?} is not an SPDX expression ({reason}); write one like CC-BY-4.0")]
    Syntax { license: String, reason: String },
}

impl LicenseError {
    /// Returns the broken rule. Wrong grammar is an error; an unlisted id is a warning.
    #[must_use]
    pub fn rule(&self) -> &'static Rule {
        match self {
            Self::Unlisted { .. } => rule::LICENSE_UNKNOWN,
            Self::Syntax { .. } => rule::LICENSE_INVALID,
        }
    }
}

/// Checks a text against the grammar of SPDX licence expressions and the list of licences.
///
/// # Errors
/// If the text breaks the grammar, or an id is not in the list.
///
/// ```
/// use htex_format::check_license;
/// assert!(check_license("MIT OR Apache-2.0").is_ok());
/// let error = check_license("CC-BY-9.0").expect_err("there is no such licence");
/// assert_eq!(error.rule().code, "LICENSE_UNKNOWN");
/// ```
pub fn check_license(license: &str) -> Result<(), LicenseError> {
    match expression::check(license) {
        Ok(None) => Ok(()),
        Ok(Some(id)) => Err(LicenseError::Unlisted { id: id.to_owned() }),
        Err(reason) => {
            Err(LicenseError::Syntax { license: license.to_owned(), reason: reason.to_owned() })
        }
    }
}
