//! What to sweep.

use std::path::PathBuf;

use htex_host::LoadedModel;

/// A model, loaded in one or more ways: `built in`, `native`, `wasm`. The first is measured
/// with all knobs, the others at their defaults.
#[derive(Debug, Clone)]
pub struct Model {
    /// Name of a way of loading, and the model loaded so; at least one.
    pub ways: Vec<(String, LoadedModel)>,
}

/// Options of a sweep.
#[derive(Debug, Clone)]
pub struct Request {
    pub models: Vec<Model>,
    /// Whether to vary one knob at a time with three values each, and to time fewer runs.
    pub quick: bool,
    /// The file of the program or library with this code: a journal of another build is not continued.
    pub program: PathBuf,
}
