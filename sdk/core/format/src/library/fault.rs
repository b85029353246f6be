//! A violation of a rule of the format; the caller converts it to an error or a finding.

use htex_base::finding::{Findings, Rule};

use crate::library::error::LibraryError;
use crate::library::rules as rule;
use crate::library::wire::WireError;

/// A broken rule, the place in the file that breaks it, and a message that says what is wrong and
/// what to do.
#[derive(Debug, Clone)]
pub(crate) struct Fault {
    pub rule: &'static Rule,
    pub place: String,
    pub message: String,
}

impl Fault {
    pub(crate) fn new(
        rule: &'static Rule,
        place: impl Into<String>,
        message: impl Into<String>,
    ) -> Self {
        Self { rule, place: place.into(), message: message.into() }
    }

    /// Creates the fault for a page whose contents cannot be read.
    pub(crate) fn page(place: &str, malformed: WireError) -> Self {
        let message = format!("{malformed}; pack the library again");
        Self::new(rule::LIBRARY_PAGE_INVALID, place, message)
    }

    /// Creates the fault for an index that does not have the hash in the header.
    pub(crate) fn index_changed() -> Self {
        let message = "the index does not have the header's hash; get the file again";
        Self::new(rule::LIBRARY_INDEX_CHANGED, "/header", message)
    }

    pub(crate) fn add_to(self, findings: &mut Findings) {
        findings.add(self.rule, self.place, self.message);
    }
}

impl From<Fault> for LibraryError {
    fn from(fault: Fault) -> Self {
        let mut findings = Findings::default();
        fault.add_to(&mut findings);
        let findings = findings.into_list();
        Self::Invalid { findings }
    }
}

/// Returns the place of a leaf page, as written in findings.
pub(crate) fn leaf_place(leaf: usize) -> String {
    format!("/leaves/{leaf}")
}

/// Returns the place of the page with the spectra of a leaf, as written in findings.
pub(crate) fn spectra_place(leaf: usize) -> String {
    format!("/spectra/{leaf}")
}

/// Returns the place of an entry, as written in findings.
pub(crate) fn entry_place(leaf: usize, entry: usize) -> String {
    format!("/leaves/{leaf}/entries/{entry}")
}
