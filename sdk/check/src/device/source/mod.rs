//! The checks of sources, with one check for each guarantee of the source ABI, as for devices.
//!
//! A source is called as a recording calls it, through [`htex_device::SourceAdapter`]. For a
//! built-in source, checks of a library's exports are skipped.

mod case;
mod describe;
mod read;
mod table;

pub use table::CHECKS;
