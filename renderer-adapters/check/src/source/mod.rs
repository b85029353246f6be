//! The checks of sources: one for each guarantee of the source ABI, as for devices.
//!
//! A source is called as a recording calls it, through [`htex_device::SourceAdapter`]; checks of a
//! library's exports are skipped for one that is built in.

mod case;
mod describe;
mod read;
mod table;

pub use table::CHECKS;
