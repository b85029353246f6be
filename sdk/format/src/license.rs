//! SPDX licence expressions.

use spdx::{Expression, ParseMode};

use crate::Rule;
use crate::rules as rule;

/// The standard's grammar and list; deprecated ids are still licences.
const LISTED: ParseMode = ParseMode {
    allow_deprecated: true,
    ..ParseMode::STRICT
};

/// Checks a text against the grammar of SPDX licence expressions and the list of licences.
///
/// # Errors
/// The broken rule and a message: an error for wrong grammar, a warning for an id that is not in
/// the list (which grows).
///
/// ```
/// use htex_format::check_license;
/// assert!(check_license("MIT OR Apache-2.0").is_ok());
/// let (rule, _) = check_license("CC-BY-9.0").expect_err("there is no such licence");
/// assert_eq!(rule.code, "LICENSE_UNKNOWN");
/// ```
pub fn check_license(license: &str) -> Result<(), (&'static Rule, String)> {
    let Err(unlisted) = Expression::parse_mode(license, LISTED) else {
        return Ok(());
    };
    let any_id = ParseMode {
        allow_unknown: true,
        ..LISTED
    };
    match Expression::parse_mode(license, any_id) {
        Ok(_) => {
            let word = license.get(unlisted.span).unwrap_or(license);
            let message = format!(
                "{word:?} is not in the SPDX list; correct it, or write LicenseRef-NAME for a \
                 licence of your own"
            );
            Err((rule::LICENSE_UNKNOWN, message))
        }
        Err(error) => {
            let message = format!(
                "{license:?} is not an SPDX expression ({}); write one like CC-BY-4.0",
                error.reason
            );
            Err((rule::LICENSE_INVALID, message))
        }
    }
}
