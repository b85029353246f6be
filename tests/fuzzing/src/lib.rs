//! What is done with input that nobody vouches for: one function a fuzz target, which goes as deep
//! as an application would and panics when a promise is broken.
//!
//! The programs in `fuzz/` call these functions, and so does the test that runs all seeds and
//! regressions (`tests/tests/regressions.rs`): a finding is the same in both.
#![forbid(unsafe_code)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // A panic is a finding.

mod asset;
mod block;
mod body;
mod container;
mod descriptor;
mod manifest;
mod module;
mod promise;
mod recordings;
mod response;
mod scene;
pub mod seeds;
mod signed;

/// A fuzz target.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// Its name: of the program in `fuzz/fuzz_targets`, and of the folders of its seeds and
    /// regressions.
    pub name: &'static str,
    /// Reads the input and uses what it holds. True when there was something to use, false when it
    /// was refused as it should be.
    ///
    /// # Panics
    /// When a promise is broken.
    pub run: fn(&[u8]) -> bool,
}

/// All targets.
pub const TARGETS: &[Target] = &[
    target("open_asset", asset::open_asset),
    target("manifest", manifest::manifest),
    target("parameter_block", block::parameter_block),
    target("csv", recordings::csv),
    target("wav", recordings::wav),
    target("npy", recordings::npy),
    target("response_csv", response::response_csv),
    target("scene", scene::scene),
    target("descriptor", descriptor::descriptor),
    target("wasm_module", module::wasm_module),
    target("signed_plugin", signed::signed_plugin),
];

const fn target(name: &'static str, run: fn(&[u8]) -> bool) -> Target {
    Target { name, run }
}

/// Runs the target of this name.
///
/// # Panics
/// When a promise is broken, or there is no such target.
pub fn run(name: &str, input: &[u8]) -> bool {
    let target = TARGETS.iter().find(|target| target.name == name);
    (target.expect("the name of a target").run)(input)
}
