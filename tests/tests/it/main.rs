//! Integration tests, in one program.
#![allow(
    unreachable_pub,
    clippy::panic,
    clippy::unwrap_used,
    dead_code,
    reason = "a failed test may panic"
)]

mod abi;
mod architecture;
mod bands;
mod common;
mod decibel_fits;
mod desktop;
mod device_abi;
mod edges;
mod fields;
mod follows_motion;
mod gltf;
mod golden_models;
mod golden_pipeline;
mod independent;
mod kaitai;
mod levels;
mod library_elsewhere;
mod lines;
mod map_model;
mod modules;
mod pages;
mod playing;
mod probes;
mod regressions;
mod schemas;
mod third_party;
mod voices;
