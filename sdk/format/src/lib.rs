//! The `.htex` container: types, reading, writing, validation.
//!
//! `spec/htex-1.md` is the normative text. This crate knows no signal processing and no model.
#![forbid(unsafe_code)]

mod archive;
mod asset;
mod block;
mod check_manifest;
mod check_plugins;
mod check_representation;
mod container;
mod document;
mod error;
mod finding;
mod limits;
mod manifest;
mod manifest_json;
mod measure;
mod packed;
mod page;
mod plain;
mod plugin;
mod replace;
mod report;
mod rounding;
mod rules;
mod validate;
mod zip_records;

pub use asset::Asset;
pub use block::{round_parameters, stored_bytes};
pub use document::{Document, DocumentRules, Opened, escape};
pub use error::{ReadError, WriteError, summary};
pub use finding::{Finding, Severity};
pub use limits::Limits;
pub use manifest::{
    AtCondition, Band, Condition, Field, LATERAL_FORCE, Manifest, NEWTON, Plugin, Provenance,
    Quality, Reference, Representation, SAME_CONDITION, Signature, Source, Steps, Store, VERSION,
};
pub use measure::ErrorMeasure;
pub use page::{manifest_schema, rules_page, validation_page};
pub use plain::plain;
pub use replace::{replace_file, write_file};
pub use report::{Findings, Report};
pub use rules::{RULES, Rule, explain};
pub use validate::validate;
