//! The `htex` command.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command and returns its exit status. `program` is the command line that starts the same
/// command in a separate process.
#[pyfunction]
pub(crate) fn run(py: Python<'_>, arguments: Vec<OsString>, program: Vec<OsString>) -> u8 {
    py.detach(|| htex_cli::run(arguments, program))
}
