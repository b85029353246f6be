//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::panic, clippy::unwrap_used, reason = "a failed test may panic")]

mod common;
#[cfg(feature = "wasm")]
mod follows_motion;
#[cfg(feature = "wasm")]
mod hostile;
#[cfg(feature = "wasm")]
mod limits;
mod own_model;
#[cfg(feature = "wasm")]
mod registry;
mod runtime_model;
#[cfg(feature = "wasm")]
mod three_ways;
