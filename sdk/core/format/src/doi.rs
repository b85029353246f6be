//! Syntax of digital object identifiers (ISO 26324): `10.`, the number of the registrant, a slash
//! and a name.

use crate::MetadataError;

/// Checks the syntax of a DOI. The function does not check whether the DOI is registered.
///
/// # Errors
/// Returns [`MetadataError::Doi`] if the text is not a DOI. The message says what to write instead.
///
/// ```
/// assert!(htex_format::check_doi("10.5281/zenodo.1234567").is_ok());
/// assert!(htex_format::check_doi("https://doi.org/10.5281/zenodo.1").is_err());
/// ```
pub fn check_doi(doi: &str) -> Result<(), MetadataError> {
    if is_doi(doi) {
        return Ok(());
    }
    let doi = doi.to_owned();
    Err(MetadataError::Doi { doi })
}

fn is_doi(doi: &str) -> bool {
    let Some((prefix, name)) = doi.split_once('/') else {
        return false;
    };
    let mut registrant = prefix.split('.');
    let is_number = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
    let is_first = |part: &str| is_number(part) && (4..=9).contains(&part.len());
    registrant.next() == Some("10")
        && registrant.next().is_some_and(is_first)
        && registrant.all(is_number)
        && !name.is_empty()
        && name.bytes().all(|b| b.is_ascii_graphic())
}

#[cfg(test)]
mod tests {
    use super::check_doi;

    #[test]
    fn a_doi_is_known_by_its_form() {
        for doi in [
            "10.5281/zenodo.1234567",
            "10.1000.10/123",
            "10.1109/TOH.2013.30",
            "10.1002/(SICI)1097-0258(19980815/30)17:15<1661::AID>3.0.CO;2-2",
        ] {
            assert_eq!(check_doi(doi), Ok(()), "{doi}");
        }
        let wrong = [
            "",
            "10.5281",
            "10.5281/",
            "10.52/x",
            "11.5281/x",
            "10.5281a/x",
            "10.5281./x",
            "10.5281/a b",
            "10.5281/\u{fc}",
            "https://doi.org/10.5281/zenodo.1",
            "doi:10.5281/zenodo.1",
        ];
        for doi in wrong {
            assert!(check_doi(doi).is_err(), "{doi}");
        }
    }
}
