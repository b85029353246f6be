//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::panic, clippy::unwrap_used, reason = "a failed test may panic")]

mod common;
mod felt;
mod fluctuation;
mod grid;
mod law;
mod read;
mod recorded;
mod recording_conformance;
mod report;
mod segments;
mod simulate;
mod simulate_truth;
mod synthesis;
