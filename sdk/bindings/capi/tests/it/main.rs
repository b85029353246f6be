//! Integration tests, in one program.
#![allow(
    unreachable_pub,
    clippy::panic,
    clippy::unwrap_used,
    unsafe_code,
    reason = "a failed test may panic"
)]

mod common;
#[cfg(target_os = "linux")]
mod fmod;
mod header;
#[cfg(target_os = "linux")]
mod hosts;
mod misuse;
mod programs;
mod readers;
mod signed;
#[cfg(target_os = "linux")]
mod unity;
