//! Integration tests, in one program.
#![allow(
    unreachable_pub,
    clippy::panic,
    clippy::unwrap_used,
    unexpected_cfgs,
    reason = "a failed test may panic"
)]

mod crossing;
mod guardian_zero;
mod source_crossing;
