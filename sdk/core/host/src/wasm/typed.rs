//! Gives the types of a module's typed functions the names that both engines use.

pub(super) use wasmtime::{TypedFunc, WasmParams as Parameters, WasmResults as Returned};
