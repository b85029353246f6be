//! Tasks that tests use too.

pub mod bench;
pub mod fuzz;
pub mod needs;
pub mod plugins;
mod wasm;
