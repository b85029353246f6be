//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::unwrap_used, reason = "a failed test may panic")]

mod c;
mod common;
mod conformance;
mod hostile;
mod playing;
