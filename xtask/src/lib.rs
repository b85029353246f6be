//! Tasks that tests use too.

pub mod fuzz;
pub mod plugins;
mod wasm;
