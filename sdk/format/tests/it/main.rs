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
mod library_common;
mod library_conformance;
mod library_hostile;
mod library_ratio;
mod library_round_trip;
mod library_specification;
mod limits;
mod measures;
mod round_trip;
mod size;
mod specification;
