//! Reads, writes and validates `.htex` files (tactile texture assets).
//!
//! `spec/htex-1.md` is the normative specification of the format. This crate does no signal
//! processing and never loads a model. To check the parameters in a file, the crate compares the
//! file's fields with the fields in the model's descriptor. The caller provides the descriptor.
//!
//! ```
//! use htex_format::{Limits, validate};
//!
//! let report = validate(b"not an asset", &Limits::default());
//! assert!(!report.valid);
//! assert_eq!(report.findings[0].code, "ARCHIVE_INVALID");
//! ```
#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod appearance;
mod archive;
mod asset;
mod block;
mod check_manifest;
mod check_plugins;
mod check_representation;
mod coded;
mod coding;
mod container;
mod document;
mod doi;
mod entry_ranges;
mod error;
mod fields;
mod fluctuation;
mod json_text;
mod law;
#[cfg(feature = "library")]
#[allow(missing_docs, reason = "fields and variants name what they hold")]
pub mod library;
mod license;
mod limits;
mod manifest;
mod manifest_json;
mod measure;
mod packed;
mod page;
mod quality;
mod quality_json;
#[cfg(feature = "schemars")]
mod quality_schema;
mod quantity;
mod range_coder;
mod rights;
mod rounding;
mod rules;
#[cfg(feature = "schemars")]
mod schema_words;
#[cfg(feature = "schemars")]
mod schemas;
#[allow(missing_docs, reason = "fields and variants name what they hold")]
pub mod signing;
mod stages;
mod table;
mod triangles;
mod typed;
mod unpack;
mod validate;
#[cfg(feature = "write")]
mod writing;
mod zip_records;
#[cfg(feature = "write")]
mod zip_writer;

pub use appearance::{APPEARANCE, Appearance, Pattern};
pub use asset::Asset;
pub use block::{round_parameters, round_within, stored_bytes};
pub use check_manifest::check_extension_name;
pub use document::{Document, DocumentRules, VersionedJson};
pub use doi::check_doi;
pub use entry_ranges::{EntryRange, entry_ranges};
pub use error::{MetadataError, ReadError, WriteError};
pub use fields::{FieldMismatch, FieldOrder, KnownModel, match_fields, stored_unit};
pub use fluctuation::Fluctuation;
pub use htex_base::files::{remove_unfinished, replace_file, write_file};
pub use htex_base::finding::{FileReport, Finding, Report, Severity};
pub use htex_model::{Band, is_model_id};
pub use json_text::{JsonError, parse_json};
pub use law::{Contact, Exponent, ExponentSource, Law, MOST_EXPONENT};
pub use license::check_license;
pub use limits::Limits;
pub use manifest::{
    AtCondition, CODED, Condition, HATT, How, Ingredient, Made, Manifest, Plugin, Provenance,
    Reference, Representation, SAME_CONDITION, Signature, Source, Steps, StoredAs, StoredField,
    VERSION,
};
pub use measure::{By, ErrorMeasure, Measure, MeasureKind, MeasureRow};
pub use page::validation_page;
pub use quality::{HeldOut, KeyedMeasures, LeftOut, Measures, Quality};
pub use quantity::{Quantity, UnknownName};
pub use rights::{Rights, license_file, read_license_file};
pub use rules::{
    DESCRIPTOR_INVALID, EXTENSION_SCHEMA_BROKEN, PLUGIN_UNUSABLE, RULES, SCHEMA_BROKEN,
};
#[cfg(feature = "schemars")]
pub use schemas::{appearance_schema, manifest_schema, report_schema};
pub use stages::{STAGES, rules_of};
pub use triangles::{Triangle, TrianglesError, check_triangles};
pub use validate::{manifest_bytes, manifest_json, validate, validate_with};
