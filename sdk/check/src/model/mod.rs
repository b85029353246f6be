//! The checker for texture models, with one check for each guarantee of the model ABI.
//! [`crate::harness`] runs each check in a separate process, so that a crash or an endless loop
//! becomes a finding.
//!
//! [`CHECKS`] is the table of checks. [`check`] runs all checks on a model file. [`run_one`] runs
//! one check in this process, for a debugger. [`bench()`] measures the rendering time of models.
//!
//! ```
//! use htex_check::model::{CHECKS, model_checks_page};
//! assert!(CHECKS.iter().any(|check| check.name == "level"));
//! assert!(model_checks_page().contains("| level |"));
//! ```
//!
//! A model is checked from outside, by the same calls that a host makes. The tests run the checker
//! on the faulty models in `tests/bad-plugins`. The checker must report exactly the guarantee that
//! each model violates.
#![deny(unsafe_code)] // Allowed in `allocator` and `pages` only.

#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
mod allocator;
mod bench;
mod case;
mod checks;
mod fence;
mod page;
#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
mod pages;
mod random;
mod report;
mod runner;
mod sets;
mod signal;
mod spectra;
mod start;
mod table;
#[cfg(not(all(target_os = "linux", target_pointer_width = "64")))]
mod vector;

pub use crate::harness::{CheckError, Finding, Outcome, Runner};
pub use bench::{BLOCKS, BlockCost, Cost, Subject, Timing, bench};
pub use case::Settings;
pub use page::model_checks_page;
pub use report::{ModelFile, Report};
pub use runner::{Options, check, run_one};
pub use start::Start;
pub use table::CHECKS;
