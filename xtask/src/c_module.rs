//! Models in C, compiled to WASM modules by clang.

use std::path::Path;
use std::process::Command;

use crate::places::workspace;

/// Compiles a source of the workspace to a module; the path of the module is absolute.
///
/// # Errors
/// A message of what is missing or of the compiler's status; its own output has been printed.
pub fn build(source: &str, module: &Path) -> Result<(), String> {
    let mut clang = Command::new("clang");
    clang.args([
        "--target=wasm32",
        "-std=c11",
        "-O2",
        "-ffp-contract=off",
        "-fno-math-errno",
    ]);
    clang.args([
        "-fvisibility=hidden",
        "-ffreestanding",
        "-nostdlib",
        "-Wl,--no-entry",
    ]);
    for include in [
        "spec/include",
        "sdk/check/templates/c",
        "examples/model-c-bursts",
    ] {
        clang.arg("-I").arg(workspace().join(include));
    }
    clang.arg("-o").arg(module).arg(workspace().join(source));
    let status = clang.status().map_err(|error| format!("clang: {error}"))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("clang cannot compile {source}: {status}"))
    }
}
