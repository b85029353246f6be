//! The bodies of the fuzz targets, one function each. A target processes untrusted input as far as
//! an application would, and panics if a promise is broken.
//!
//! Both the programs in `fuzz/` and the test that runs all seeds and regressions
//! (`tests/tests/it/regressions.rs`) call these functions, so a finding is the same in both.
#![cfg(feature = "wasm")]
#![deny(unsafe_code)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // A panic is a finding.

mod asset;
mod baked;
mod block;
mod body;
mod capi;
mod compile;
mod container;
mod descriptor;
pub mod edges;
mod exchange;
mod heavy;
mod lab;
mod library;
mod manifest;
mod module;
mod output;
mod printed;
mod promise;
mod recipe;
mod recipe_folder;
mod recordings;
mod response;
mod scene;
pub mod seeds;
mod signed;
mod studies;
mod take;
mod toml_text;

pub use asset::open_asset;
pub use baked::baked_block;
pub use block::parameter_block;
pub use capi::c_calls;
pub use compile::compile_limits;
pub use container::{container, with_checksums};
pub use descriptor::descriptor;
pub use exchange::{ahap, gltf, haptic, hatt, hjif, png};
pub use lab::{arrow, column_map, flac, hdf5, mat, parquet, tdms};
pub use library::library;
pub use manifest::manifest;
pub use module::wasm_module;
pub use output::output_name;
pub use printed::printed_text;
pub use recipe::recipe;
pub use recipe_folder::recipe_folder;
pub use recordings::{csv, npy, wav};
pub use response::response_csv;
pub use scene::scene;
pub use signed::signed_plugin;
pub use studies::{answers, study};
pub use take::take_part;
pub use toml_text::toml_text;

/// A fuzz target.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// The name of its program in `fuzz/fuzz_targets`, and of the folders of its seeds and
    /// regressions.
    pub name: &'static str,
    /// Reads the input and uses its content. Returns true if the input was accepted, false if it
    /// was refused with a valid error.
    ///
    /// # Panics
    /// When a promise is broken.
    pub run: fn(&[u8]) -> bool,
}

pub const TARGETS: &[Target] = &[
    target("open_asset", open_asset),
    target("manifest", manifest),
    target("parameter_block", parameter_block),
    target("csv", csv),
    target("wav", wav),
    target("npy", npy),
    target("flac", flac),
    target("mat", mat),
    target("tdms", tdms),
    target("parquet", parquet),
    target("arrow", arrow),
    target("hdf5", hdf5),
    target("column_map", column_map),
    target("response_csv", response_csv),
    target("scene", scene),
    target("descriptor", descriptor),
    target("wasm_module", wasm_module),
    target("signed_plugin", signed_plugin),
    target("printed_text", printed_text),
    target("output_name", output_name),
    target("compile_limits", compile_limits),
    target("c_calls", c_calls),
    target("baked_block", baked_block),
    target("library", library),
    target("study", study),
    target("answers", answers),
    target("recipe", recipe),
    target("recipe_folder", recipe_folder),
    target("toml_text", toml_text),
    target("take_part", take_part),
    target("hatt", hatt),
    target("haptic", haptic),
    target("ahap", ahap),
    target("hjif", hjif),
    target("gltf", gltf),
    target("png", png),
];

const fn target(name: &'static str, run: fn(&[u8]) -> bool) -> Target {
    Target { name, run }
}

/// Runs the target with this name.
///
/// # Panics
/// When a promise is broken, or the target is unknown.
pub fn run(name: &str, input: &[u8]) -> bool {
    let target = TARGETS.iter().find(|target| target.name == name);
    (target.expect("the name of a target").run)(input)
}
