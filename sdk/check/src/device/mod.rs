//! The checker for devices, with one check for each guarantee of the device ABI. [`crate::harness`]
//! runs each check in its own process, so that a crash or an endless loop becomes a finding.
//!
//! [`CHECKS`] is the table of checks. Some checks apply only to outputs or only to inputs
//! ([`checks_of`]). [`check`] runs the checks of one device, and [`run_one`] runs a single check in
//! this process. The checks call a device in the same way as a scene or a recording does, through
//! [`htex_device::Adapter`]. For a built-in device, the checker skips the checks of a library's
//! exports. The checks drive an output at a hundredth of its limit. But some checks also pass
//! samples beyond the limit to the device. Nobody may touch a device while the checks run.
//!
//! The faulty devices in `tests/bad-devices` test this checker.
#![forbid(unsafe_code)]

mod case;
mod checks;
mod runner;
mod table;

pub use case::{Case, Subject};
pub use htex_device::Direction;
pub use runner::{DeviceName, Report, check, run_one};
pub use table::{CHECKS, checks_of};
