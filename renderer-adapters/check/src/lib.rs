//! The checker of devices, and in [`source`] that of sources: one check for each promise of the ABI, run by [`htex_check_runner`] in a process of its own,
//! so that a crash or an endless loop becomes a finding.
//!
//! [`CHECKS`] is the table; [`check`] runs it over a device; [`run_one`] runs one check in this process. A device is called
//! as a scene calls it, through [`htex_device::Adapter`]; checks of a library's exports are skipped for a built-in device.
//! Devices are driven at a hundredth of their limit, and offered samples beyond it: nobody may touch one while it is checked.
//!
//! The faults in `tests/bad-devices` and `tests/bad-sources` test these checkers.
#![forbid(unsafe_code)]

mod case;
mod checks;
mod report;
mod runner;
pub mod source;
mod table;

pub use case::Subject;
pub use htex_check_runner::{Finding, Runner, UnknownCheck};
pub use report::{DeviceName, Report};
pub use runner::{check, run_one};
pub use table::CHECKS;
