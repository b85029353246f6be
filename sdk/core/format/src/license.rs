//! Checks SPDX licence expressions.

mod expression;

use crate::MetadataError;

/// Checks a text against the grammar of SPDX licence expressions and the list of licences.
///
/// # Errors
/// Returns an error if the text breaks the grammar, or if an id is not in the list.
///
/// ```
/// use htex_format::check_license;
/// assert!(check_license("MIT OR Apache-2.0").is_ok());
/// let error = check_license("CC-BY-9.0").expect_err("there is no such licence");
/// assert_eq!(error.rule().code, "LICENSE_UNKNOWN");
/// ```
pub fn check_license(license: &str) -> Result<(), MetadataError> {
    match expression::check(license) {
        Ok(None) => Ok(()),
        Ok(Some(id)) => Err(MetadataError::UnlistedLicense { id: id.to_owned() }),
        Err(reason) => {
            Err(MetadataError::License { license: license.to_owned(), reason: reason.to_owned() })
        }
    }
}
