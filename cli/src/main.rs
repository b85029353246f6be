//! The `htex` program.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    let program = std::env::current_exe().map(|file| vec![file.into_os_string()]);
    ExitCode::from(htex_cli::run(std::env::args_os(), program.unwrap_or_default()))
}
