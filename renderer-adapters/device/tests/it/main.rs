//! Integration tests, in one program.
#![allow(
    unreachable_pub,
    clippy::panic,
    clippy::unwrap_used,
    unexpected_cfgs,
    reason = "a failed test may panic"
)]

mod guardian_zero;
mod input_crossing;
mod output_crossing;
