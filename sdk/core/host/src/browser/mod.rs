//! Runs models in WASM modules with the engine of the browser, or of Node.js, that runs this
//! program.
//!
//! Modules follow the same rules as with the engine of the feature `wasm`. A module imports
//! nothing, and its memory and tables are limited. Each voice has a separate instance, and the host
//! does not call an instance again after a trap. But the engine of a browser cannot interrupt a
//! call. If a call takes longer than its limit, it runs to its end, and then returns an error. An
//! endless loop in a module ends only when the page stops the worker that runs the module
//! (`sdk/bindings/web/src/guarded.js`).
//!
//! This Rust module contains only the browser's engine. The code that loads models is shared with
//! `wasm` (`calls.rs`, `model.rs`, `voice.rs`).

#[path = "../wasm/allowance.rs"]
mod allowance;
#[path = "../wasm/calls.rs"]
mod calls;
// Some faults are reported only by the engine of the feature `wasm`.
#[allow(dead_code)]
#[path = "../wasm/fault.rs"]
mod fault;
#[path = "../wasm/functions.rs"]
mod functions;
mod guest;
mod imports;
#[path = "../wasm/instance.rs"]
mod instance;
#[path = "../wasm/model.rs"]
mod model;
mod module;
mod sections;
#[path = "../wasm/shared.rs"]
mod shared;
mod typed;
#[path = "../wasm/voice.rs"]
mod voice;

use std::sync::Arc;

pub(crate) use model::WasmModel;
use module::WasmModule;

use crate::HostError;
use crate::sandbox::Sandbox;

/// Loads a model from the bytes of a module. `origin` is the module's name in messages.
pub(crate) fn load(origin: &str, bytes: &[u8], sandbox: &Sandbox) -> Result<WasmModel, HostError> {
    let module = WasmModule::new(bytes, sandbox).map_err(HostError::loading(origin))?;
    WasmModel::new(origin, Arc::new(module))
}
