//! A checker that device authors can trust: every promise of the device ABI is one check, and each
//! check runs in a process of its own, so that a crash or an endless loop is an answer too.
//!
//! [`CHECKS`] is the list; [`check`] runs it over a device; [`run_one`] runs one of them in this
//! process. A device is called as a scene calls it, through [`htex_device::Adapter`]; what only a
//! library can do wrong is skipped for a built-in one. Devices are driven at a hundredth of their
//! limit, and beyond it once: nobody touches one while it is checked.
#![forbid(unsafe_code)]

mod case;
mod checks;
mod report;
mod runner;
mod table;

pub use case::Subject;
pub use report::DeviceReport;
pub use runner::{Options, check, run_one};
pub use table::{CHECKS, Check};
