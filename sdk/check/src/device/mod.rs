//! The checker for devices, with one check for each guarantee of the device ABI. [`crate::harness`]
//! runs each check in its own process, so that a crash or an endless loop becomes a finding.
//!
//! [`CHECKS`] is the table of checks. Some checks apply only to output devices or only to input
//! devices ([`checks_of`]). [`check`] runs the checks of one device, and [`run_one`] runs a single
//! check in this process. Like the programs that play scenes or make recordings, the checks call a
//! device through [`htex_device::Adapter`]. A built-in device is not a library, so the checker
//! skips the checks of library exports for it. Most checks send an output device a quiet tone, at a
//! hundredth of the device's limit. But some checks also send samples above this limit. Nobody may
//! touch a device while the checks run.
//!
//! The tests run this checker on the faulty devices in `tests/bad-devices`.
#![forbid(unsafe_code)]

mod case;
mod checks;
mod runner;
mod table;

pub use case::{Case, Subject};
pub use htex_device::Direction;
pub use runner::{DeviceName, Report, check, run_one};
pub use table::{CHECKS, checks_of};
