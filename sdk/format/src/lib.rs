//! The `.htex` container: types, reading, writing, validation.
//!
//! `spec/htex-1.md` is the normative text. This crate knows no signal processing and no model.
#![forbid(unsafe_code)]

mod asset;
mod finding;
mod manifest;

pub use asset::Asset;
pub use finding::{Finding, Severity};
pub use manifest::{
    AtCondition, Band, Condition, Field, LATERAL_FORCE, Manifest, NEWTON, Provenance, Quality,
    Reference, Representation, Source, Steps, Store, VERSION,
};
