//! Integration tests, in one program.
#![allow(
    unreachable_pub,
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a failed test may panic"
)]

mod common;
mod conformance;
mod hostile;
#[cfg(feature = "library")]
mod library_common;
#[cfg(feature = "library")]
mod library_conformance;
#[cfg(feature = "library")]
mod library_hostile;
#[cfg(feature = "library")]
mod library_ratio;
#[cfg(feature = "library")]
mod library_round_trip;
#[cfg(feature = "library")]
mod library_specification;
mod limits;
mod measures;
mod mutations;
mod round_trip;
mod size;
mod specification;
