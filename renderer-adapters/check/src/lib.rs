//! The checker of devices and of sources: one check for each promise of their ABI, run by
//! [`htex_check_runner`] in a process of its own, so that a crash or an endless loop becomes a
//! finding.
//!
//! [`CHECKS`] is the table of devices, [`source::CHECKS`] that of sources; [`check`] runs it over
//! one of them; [`run_one`] runs one check in this process. A device is called as a scene calls it,
//! through [`htex_device::Adapter`]; checks of a library's exports are skipped for a built-in
//! device. Devices are driven at a hundredth of their limit, and offered samples beyond it: nobody
//! may touch one while it is checked.
//!
//! The faults in `tests/bad-devices` and `tests/bad-sources` test these checkers.
#![forbid(unsafe_code)]

mod case;
mod checks;
mod device;
mod report;
pub mod source;
mod table;

pub use case::{Case, CaseKind, CheckedKind, Subject, check, run_one};
pub use htex_check_runner::{Finding, Runner, UnknownCheck};
pub use report::{AdapterName, Report};
pub use table::CHECKS;
