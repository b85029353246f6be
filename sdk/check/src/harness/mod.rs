//! The common part of the checkers for models and for devices: a table of checks ([`checks!`]), a
//! runner, and the report. The runner runs each check in a separate process, so that a crash or an
//! endless loop becomes a finding.
//!
//! ```
//! use htex_check::harness::{CheckResult, Finding, Owner, run_one};
//!
//! fn positive(number: &i32) -> CheckResult {
//!     if *number > 0 {
//!         Ok(Finding::passed("it is positive"))
//!     } else {
//!         Err(Finding::failed(format!("{number} is not positive")))
//!     }
//! }
//!
//! htex_check::harness::checks! { i32;
//!     "positive" needs [] positive:
//!         "The number is positive.",
//!         "It is compared with 0.";
//! }
//!
//! let load = || "-1".parse::<i32>();
//! let finding = run_one(CHECKS, "positive", load, |_| Owner::reached("positive"))?;
//! assert_eq!(finding.message, "-1 is not positive");
//! # Ok::<(), htex_check::harness::CheckError>(())
//! ```
#![forbid(unsafe_code)]

mod common;
mod error;
mod finding;
mod process;
mod report;
mod runner;
mod table;

pub use crate::checks;
pub(crate) use common::{Growth, made_up_extensions, memory};
pub use error::CheckError;
pub use finding::{CheckResult, Finding, Outcome};
pub(crate) use process::run_process;
pub use report::{CheckReport, Report};
pub(crate) use runner::run_all;
pub use runner::{Owner, Runner, run_one};
pub use table::Check;
pub(crate) use table::select;
