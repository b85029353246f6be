use clap::Args;

use crate::failure::{Exit, Failure, Result};

/// Compile the WASM module on standard input for the process that started this one (internal).
#[derive(Args)]
#[command(hide = true)]
pub(crate) struct CompileModule {
    /// The limits, in the form in which that process passes them
    arguments: Vec<String>,
}

impl CompileModule {
    pub(crate) fn run(self) -> Result {
        htex_host::serve_compiler(&self.arguments).map_err(Failure::other)?;
        Ok(Exit::SUCCESS)
    }
}
