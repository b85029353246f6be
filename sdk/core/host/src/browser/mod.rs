//! Runs models in WASM modules with the engine of the browser, or of Node.js, that runs this
//! program.
//!
//! The rules are the same as for the engine of the feature `wasm`: a module imports nothing, its
//! memory and tables are limited, each voice has a separate instance, and an instance that trapped
//! is not called again. But this engine cannot interrupt a call. A call that took longer than its
//! limit returns an error afterwards. An endless loop ends only when the worker that runs it is
//! stopped (`sdk/bindings/web/src/guarded.js`).
//!
//! This module contains only the engine. It shares the loader with `wasm` (`calls.rs`, `model.rs`,
//! `voice.rs`).

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
