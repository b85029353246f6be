//! The conformance files of libraries, their reports, and the page of findings.

use crate::conformance::codes_of;
use crate::library_common as common;

use std::collections::BTreeSet;

use common::cases::cases;
use htex_format::library::{Library, RULES, findings_page};
use xtask::generated::{file, folder};

#[test]
fn generated_files_and_their_reports_are_fresh() {
    let mut files = Vec::new();
    for case in cases() {
        let path = |end: &str| format!("spec/library-conformance/{}.{end}", case.name);
        files.push((path("report.json"), case.golden().into_bytes()));
        files.push((path("htexlib"), case.bytes));
    }
    folder("spec/library-conformance", &files);
}

#[test]
fn generated_page_is_fresh() {
    file("spec/library-findings.md", findings_page().as_bytes());
}

#[test]
fn a_file_is_named_after_the_rule_it_breaks_and_every_rule_has_one() {
    let mut raised = BTreeSet::new();
    for case in cases() {
        let report = case.report();
        raised.extend(codes_of(&case.name, &report));
        assert!(!report.valid || case.name.starts_with("valid"), "{}: {report:?}", case.name);
    }
    let rules: BTreeSet<String> = RULES.iter().map(|rule| rule.code.to_owned()).collect();
    assert_eq!(raised, rules);
}

/// An invalid library may still open. The parts that are then read are checked.
#[test]
fn reading_refuses_what_validation_refuses_where_it_reads() {
    let only_validation = [
        "LIBRARY_COUNT_WRONG",
        "LIBRARY_NAMES_ALIKE",
        "LIBRARY_INDEX_CHANGED",
        "LIBRARY_RANGE_INVALID",
        "LIBRARY_OBJECT_UNUSED",
        "LIBRARY_OBJECTS_TOO_MANY",
        "LIBRARY_RATIO",
        "LIBRARY_ASSET_INVALID",
        "LIBRARY_ENTRY_WRONG",
    ];
    for case in cases() {
        let opened = Library::open_source_with(case.bytes.as_slice(), case.limits);
        let read = opened.and_then(|library| {
            for entry in library.entries() {
                let entry = entry?;
                library.description(&entry)?;
                library.read(&entry)?;
            }
            Ok(())
        });
        let report = case.report();
        let first = report.findings.iter().find(|f| f.code != "LIBRARY_VERSION_NEWER");
        if let Err(error) = read {
            let error = error.to_string();
            let is_found = report.findings.iter().any(|f| error.contains(&f.code));
            assert!(is_found, "{}: {error}", case.name);
        } else {
            let is_known = first.is_none_or(|f| only_validation.contains(&f.code.as_str()));
            assert!(is_known, "{} is read: {first:?}", case.name);
        }
    }
}
