//! The checker for devices and sources, with one check for each guarantee of their ABI.
//! [`crate::harness`] runs each check in its own process, so that a crash or an endless loop
//! becomes a finding.
//!
//! [`CHECKS`] is the table of checks for devices, [`source::CHECKS`] the one for sources. [`check`]
//! runs such a table over one adapter, and [`run_one`] runs a single check in this process. A
//! device is called as a scene calls it, through [`htex_device::Adapter`]. For a built-in device,
//! checks of a library's exports are skipped. The checks drive a device at a hundredth of its
//! limit, and they also offer it samples beyond the limit. Nobody may touch a device while it is
//! checked.
//!
//! The faults in `tests/bad-devices` and `tests/bad-sources` test these checkers.
#![forbid(unsafe_code)]

mod adapter;
mod case;
mod checks;
mod report;
pub mod source;
mod table;

pub use crate::harness::{Finding, Runner, UnknownCheck};
pub use case::{Case, CaseKind, CheckedKind, Subject, check, run_one};
pub use report::{AdapterName, Report};
pub use table::CHECKS;
