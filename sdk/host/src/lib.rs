//! Finds texture models and calls them: one registry and one way of calling, wherever a model's
//! code comes from.
//!
//! A model is built in, a native library, or a WASM module in a sandbox ([`Origin`]); [`Search`] says
//! where to look. Every model is called through the flat functions of the model ABI, the built-in ones too. What
//! a model answers is checked here, so that a wrong model is an error of that call and of nothing
//! else.
//!
//! ```
//! use htex_host::{Band, Registry};
//! let registry = Registry::builtin();
//! let model = registry.find("sbeta")?;
//! let magnitude = model.magnitude(&[2.0, 5.0], Band::TACTILE, &[50.0, 100.0])?;
//! assert!(magnitude[0] > 0.0);
//! # Ok::<(), htex_host::HostError>(())
//! ```

// A model of the tests has no library, and so no feature that exports its symbols.
#![cfg_attr(test, allow(unexpected_cfgs))]

mod builtin;
mod descriptor;
mod error;
pub mod folders;
mod limits;
mod model;
mod native;
mod note;
mod options;
mod origin;
mod own;
mod raw;
mod registry;
// Without modules nothing is spent.
#[cfg_attr(not(feature = "wasm"), allow(dead_code))]
mod sandbox;
mod search;
mod stream;
mod synthesis;
mod table;
mod together;
mod voice;
#[cfg(feature = "wasm")]
mod wasm;

pub use descriptor::read_descriptor;
pub use error::HostError;
pub use htex_dsp::grid::{Band, GRID_HZ};
pub use htex_model::{
    Descriptor, Field, Fit, FitCondition, FitOption, Kind, Motion, Status, Store,
};
pub use limits::{WasmCache, WasmCompiler, WasmLimits, WasmTotal};
pub use model::{FitRequest, LoadedModel, MOTION_EXTENSION};
pub use note::Note;
pub use origin::Origin;
pub use registry::Registry;
pub use search::Search;
pub use stream::Stream;
pub use synthesis::{StillSound, Synthesis};
pub use together::{VOICES_EXTENSION, render_together};
pub use voice::ModelVoice;
#[cfg(feature = "wasm")]
pub use wasm::serve_compiler;

/// Whether this build runs WASM modules (feature `wasm`).
pub const RUNS_WASM: bool = cfg!(feature = "wasm");
