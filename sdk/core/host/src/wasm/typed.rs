//! Types for the typed functions of a module, under the names that both engines use.

pub(super) use wasmtime::{TypedFunc, WasmParams as Parameters, WasmResults as Returned};
