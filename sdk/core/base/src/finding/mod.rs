//! Results of validation: rules with stable codes, findings, reports and hints. Each crate that
//! reads a kind of file contains the table of the rules for this kind. This crate has no rules for
//! particular files.
//!
//! ```
//! use htex_base::finding::{Findings, Severity};
//!
//! htex_base::finding::rule_table! {
//!     CLOTH_TORN Error ("needle"): "The cloth is torn.", "Torn cloth snags.", "Mend it.";
//! }
//! let mut findings = Findings::default();
//! findings.add(CLOTH_TORN, "/sleeve", "a hole of 3 mm; mend it".to_owned());
//! let report = findings.into_report();
//! assert!(!report.valid);
//! assert_eq!(report.findings[0].to_string(), "CLOTH_TORN at /sleeve: a hole of 3 mm; mend it");
//! assert_eq!(report.findings[0].hint.settings(), ["needle"]);
//! ```
#![forbid(unsafe_code)]

mod cell;
mod entry;
mod hint;
mod page;
mod plain;
mod pointer;
mod report;
mod rule;

pub use crate::rule_table;
pub use cell::as_text;
pub use entry::{Finding, Severity, listed, summary};
pub use hint::{Hint, Notice};
pub use page::{colophon, rules_page};
pub use plain::{plain, steers};
pub use pointer::{Place, escape};
pub use report::{FileReport, Findings, Report};
pub use rule::{COUNT, FINDINGS_TRUNCATED, Rule, Stage};
