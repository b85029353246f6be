use clap::Args;

use crate::failure::{Exit, Failure, Result};

/// Read a WASM module from standard input, and compile it for the process that started this command
/// (internal).
#[derive(Args)]
#[command(hide = true)]
pub(crate) struct CompileModule {
    /// The limits of the compilation, encoded by the process that started this command
    arguments: Vec<String>,
}

impl CompileModule {
    pub(crate) fn run(self) -> Result {
        htex_host::serve_compiler(&self.arguments).map_err(Failure::other)?;
        Ok(Exit::SUCCESS)
    }
}
