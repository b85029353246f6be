//! Models in C, compiled to WASM modules by clang.

use std::path::Path;
use std::process::Command;

use anyhow::Result;

use crate::places::workspace;
use crate::programs::run;

/// Compiles a source of the workspace to a module; the path of the module is absolute.
///
/// # Errors
/// A message of what is missing or of the compiler's status; its own output has been printed.
pub fn build(source: &str, module: &Path) -> Result<()> {
    let mut clang = Command::new("clang");
    clang.args(["--target=wasm32", "-std=c11", "-O2", "-ffp-contract=off", "-fno-math-errno"]);
    clang.args(["-fvisibility=hidden", "-ffreestanding", "-nostdlib", "-Wl,--no-entry"]);
    for include in ["spec/include", "sdk/check/templates/c", "examples/model-c-bursts"] {
        clang.arg("-I").arg(workspace().join(include));
    }
    clang.arg("-o").arg(module).arg(workspace().join(source));
    run(&mut clang)
}
