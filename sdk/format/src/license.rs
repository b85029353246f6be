//! SPDX licence expressions.

use spdx::{Expression, ParseMode};

use crate::Rule;
use crate::rules as rule;

/// The standard's grammar and list; ids that the list has retired are still licences.
const LISTED: ParseMode = ParseMode {
    allow_deprecated: true,
    ..ParseMode::STRICT
};

/// Holds a text to the grammar of SPDX licence expressions and to the list of licences.
///
/// # Errors
/// The rule it breaks, and what is wrong: an error of grammar, a warning for an id that is not in
/// the list (which grows).
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
                "{license:?} is no SPDX expression ({}); write one like CC-BY-4.0",
                error.reason
            );
            Err((rule::LICENSE_INVALID, message))
        }
    }
}
