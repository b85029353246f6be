//! Compiles models written in C to WASM modules, with clang.

use std::path::Path;
use std::process::Command;

use anyhow::Result;

use crate::places::workspace;
use crate::programs::run;

/// Compiles a source file of the workspace to a module. The module's path must be absolute.
///
/// # Errors
/// The error says what is missing, or gives the compiler's status. The compiler has already printed
/// its own output.
pub fn build(source: &str, module: &Path) -> Result<()> {
    let mut clang = Command::new("clang");
    // Without `errno`, `sqrt` becomes an instruction. There is no C library to call.
    clang.args(["--target=wasm32", "-std=c11", "-O2", "-ffp-contract=off", "-fno-math-errno"]);
    clang.args(["-fvisibility=hidden", "-ffreestanding", "-nostdlib", "-Wl,--no-entry"]);
    for include in ["spec/include", "sdk/check/templates/model-c", "examples/model-c-bursts"] {
        clang.arg("-I").arg(workspace().join(include));
    }
    clang.arg("-o").arg(module).arg(workspace().join(source));
    run(&mut clang)
}
