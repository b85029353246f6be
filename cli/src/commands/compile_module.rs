use std::process::ExitCode;

use clap::Args;

use crate::failure::Failure;

/// Compile the WASM module of standard input for the process at the other end (what loads models starts it).
#[derive(Args)]
#[command(hide = true)]
pub(crate) struct CompileModule {
    /// As that process gives them
    arguments: Vec<String>,
}

impl CompileModule {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        htex_host::serve_compiler(&self.arguments).map_err(Failure::Other)?;
        Ok(ExitCode::SUCCESS)
    }
}
