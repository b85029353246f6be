//! Developer tasks, and helpers for tests.

pub mod bench;
pub mod bindings;
pub mod book;
pub mod c_module;
pub mod census;
mod commit;
pub mod dist;
pub mod firmware;
pub mod fuzz;
pub mod generated;
mod jobs;
pub mod markdown;
pub mod needs;
mod places;
pub mod platform;
pub mod plugins;
pub mod programs;
pub mod prove;
pub mod registry;
pub mod release;
pub mod shelf;
pub mod shell;
pub mod studio;
mod wasm;
pub mod web;
