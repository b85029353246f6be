//! Finds and calls texture models. A program finds all models in one registry and calls them all in
//! the same way, wherever they come from.
//!
//! A model is built in, a native library, or a WASM module in a sandbox ([`Origin`]). [`Search`]
//! lists the places in which this crate looks for models. This crate calls all models, even the
//! built-in ones, through the functions of the model ABI, and checks the results of each call. If a
//! result is invalid, the call returns an error, and the program can call the model again.
//!
//! ```
//! use htex_host::{Band, Registry};
//! let registry = Registry::builtin();
//! let model = registry.find("sbeta")?;
//! let magnitude = model.magnitude(&[2.0, 5.0], Band::TACTILE, &[50.0, 100.0])?;
//! assert!(magnitude[0] > 0.0);
//! # Ok::<(), htex_host::HostError>(())
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
// `export_model!` in a unit test names a Cargo feature that this crate does not have.
#![cfg_attr(test, allow(unexpected_cfgs))]

mod builtin;
mod clock;
mod decimal;
#[cfg(feature = "descriptions")]
mod described;
mod descriptor;
mod error;
mod limits;
mod model;
mod native;
mod note;
mod options;
mod origin;
mod own;
mod probe;
mod raw;
mod reading;
mod registry;
mod runtime;
// Only modules use the budget.
#[cfg_attr(not(any(feature = "wasm", target_family = "wasm")), allow(dead_code))]
mod sandbox;
mod search;
mod stream;
mod synthesis;
mod table;
mod together;
mod voice;
#[cfg(feature = "wasm")]
mod wasm;
// This module is normally used in a browser or in Node.js, whose engine runs the WASM modules.
#[cfg(test)]
#[path = "browser/sections.rs"]
mod sections;
#[cfg(all(target_family = "wasm", not(feature = "wasm")))]
#[path = "browser/mod.rs"]
mod wasm;

pub use clock::Instant;
pub use decimal::decimal;
pub use descriptor::{DescriptorError, read_descriptor};
pub use error::HostError;
pub use htex_base::native::folders;
pub use htex_dsp::grid::{Band, GRID_HZ};
pub use htex_model::{
    Descriptor, Field, Fit, FitCondition, FitInput, FitOption, Kind, Motion, Scale, Status, Store,
    UsualRange,
};
pub use limits::{WasmCache, WasmCompiler, WasmEngine, WasmLimits, WasmTotal};
pub use model::{LoadedModel, MOTION_EXTENSION};
pub use note::Note;
pub use origin::Origin;
pub use probe::{ProbeArguments, Unusable};
pub use registry::Registry;
pub use runtime::{RuntimeModel, RuntimeVoice};
pub use search::Search;
pub use stream::Stream;
pub use synthesis::{StillSound, Synthesis};
pub use together::{VOICES_EXTENSION, render_together};
pub use voice::ModelVoice;
#[cfg(feature = "wasm")]
pub use wasm::{CompilerError, end_wasm_clocks, serve_compiler};

/// Whether this build can run WASM modules, with the engine of the feature `wasm` or in a browser.
pub const RUNS_WASM: bool = cfg!(any(feature = "wasm", target_family = "wasm"));
