//! Models in WASM modules, which run in a sandbox.
//!
//! A module imports nothing, so it has no access to files, clocks or threads. Its memory, stack,
//! time and compilation are limited ([`WasmLimits`](crate::WasmLimits)). Each voice has a separate
//! instance with separate memory, so a trap does not affect other voices, and rendering takes no
//! lock. All calls that do not belong to a voice share one instance, which is recreated after a
//! trap.

mod allowance;
mod cache;
mod calls;
mod compile;
mod compile_error;
mod engine;
mod estimate;
mod fault;
mod functions;
mod guest;
mod instance;
mod model;
mod module;
mod process;
mod shared;
mod trap;
mod typed;
mod usage;
mod voice;

use std::path::Path;
use std::sync::Arc;

pub use compile_error::CompilerError;
pub use engine::end_wasm_clocks;
pub(crate) use model::WasmModel;
use module::WasmModule;
pub use process::serve_compiler;

use crate::HostError;
use crate::sandbox::Sandbox;

/// Loads a model from the bytes of a module. `origin` is the module's name in messages.
pub(crate) fn load(origin: &str, bytes: &[u8], sandbox: &Sandbox) -> Result<WasmModel, HostError> {
    let module = WasmModule::new(bytes, sandbox).map_err(HostError::loading(origin))?;
    WasmModel::new(origin, Arc::new(module))
}

pub(crate) fn load_file(path: &Path, sandbox: &Sandbox) -> Result<WasmModel, HostError> {
    let origin = path.display().to_string();
    let bytes = read(path, sandbox.limits.module_bytes).map_err(HostError::loading(&origin))?;
    load(&origin, &bytes, sandbox)
}

/// Reads a file, but at most one byte more than the limit. The extra byte shows that a file exceeds
/// the limit.
fn read(path: &Path, most: usize) -> std::io::Result<Vec<u8>> {
    use std::io::Read;
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path)?;
    file.take(most as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}
