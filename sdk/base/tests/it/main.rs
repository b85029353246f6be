//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::unwrap_used, reason = "a failed test may panic")]

mod storage_common;
mod storage_local;
#[cfg(feature = "cloud")]
mod storage_reading;
#[cfg(feature = "cloud")]
mod storage_remote;
#[cfg(feature = "cloud")]
mod storage_restart;
#[cfg(feature = "cloud")]
mod storage_web;
#[cfg(feature = "cloud")]
mod storage_writing;
