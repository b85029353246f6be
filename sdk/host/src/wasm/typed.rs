//! Typed functions, by the names that both engines have for them.

pub(super) use wasmtime::{TypedFunc, WasmParams as Parameters, WasmResults as Returned};
