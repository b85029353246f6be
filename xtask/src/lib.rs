//! Tasks that tests use too.

pub mod plugins;
mod wasm;
