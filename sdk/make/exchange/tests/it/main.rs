//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::panic, clippy::unwrap_used, reason = "a failed test may panic")]

mod common;
mod damaged;
mod exports;
mod gltf;
mod hatt;
mod hatt_peer;
mod losses;
mod map;
mod round_trips;
mod rules;
mod table;
mod textures;
