//! Integration tests, in one program.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

mod golden;
mod properties;
