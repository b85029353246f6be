//! A checker that model authors can trust: every promise of the model ABI is one check, and each
//! check runs in a process of its own, so that a crash or an endless loop is a finding too.
//!
//! [`CHECKS`] is the list; [`check`] runs it over a model file; [`run_one`] runs one of them in
//! this process, for a debugger.
//!
//! ```
//! use htex_check::{CHECKS, model_checks_page};
//! assert!(CHECKS.iter().any(|check| check.name == "level"));
//! assert!(model_checks_page().contains("| level |"));
//! ```
#![deny(unsafe_code)] // But in `allocator`.

#[cfg(all(target_os = "linux", target_pointer_width = "64"))]
mod allocator;
mod bench;
mod case;
mod checks;
mod finding;
mod page;
mod report;
mod runner;
mod signal;
mod spectra;
mod start;
mod table;

pub use bench::{BLOCKS, BlockCost, Cost, Subject, Timing, bench};
pub use checks::resources::resident_bytes;
pub use finding::{Finding, Found, Outcome};
pub use page::model_checks_page;
pub use report::{CheckReport, Report, lines};
pub use runner::{Options, Runner, check, run_one, run_process};
pub use start::Start;
pub use table::{CHECKS, Check};
