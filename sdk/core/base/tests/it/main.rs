//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::unwrap_used, reason = "a failed test may panic")]

#[cfg(feature = "storage")]
mod storage_common;
#[cfg(feature = "storage")]
mod storage_local;
#[cfg(feature = "storage")]
#[cfg(feature = "cloud")]
mod storage_reading;
#[cfg(feature = "storage")]
#[cfg(feature = "cloud")]
mod storage_remote;
#[cfg(feature = "storage")]
#[cfg(feature = "cloud")]
mod storage_restart;
#[cfg(feature = "storage")]
#[cfg(feature = "cloud")]
mod storage_web;
#[cfg(feature = "storage")]
#[cfg(feature = "cloud")]
mod storage_writing;
