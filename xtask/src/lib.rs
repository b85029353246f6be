//! Tasks of developers and of tests.

pub mod bench;
pub mod bindings;
pub mod c_module;
pub mod dist;
pub mod fuzz;
pub mod generated;
mod jobs;
pub mod needs;
mod places;
pub mod plugins;
pub mod programs;
pub mod prove;
pub mod shelf;
pub mod studio;
mod wasm;
pub mod web;
