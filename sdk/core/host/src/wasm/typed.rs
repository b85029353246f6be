//! Typed functions, under the names that both engines use for them.

pub(super) use wasmtime::{TypedFunc, WasmParams as Parameters, WasmResults as Returned};
