//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::unwrap_used, reason = "a failed test may panic")]

#[cfg(all(feature = "library", feature = "write"))]
mod library;
mod live;
#[cfg(all(feature = "author", not(feature = "wasm")))]
mod small_player;
