//! Compares htex with plain loops in C and with Python libraries.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::Result;

use crate::places::{cargo, target};
use crate::programs::run;

/// Builds the benchmark and the command, finds Python, and runs the benchmark.
///
/// # Errors
/// If a program cannot be built or fails.
pub fn bench(json: Option<&Path>) -> Result<()> {
    let mut build = Command::new(cargo());
    run(build.args(["build", "--release", "-p", "htex-bench", "-p", "htex-cli"]))?;
    let built = target().join("release");
    let mut bench = Command::new(built.join("htex-bench"));
    if let Some(json) = json {
        bench.arg("--json").arg(json);
    }
    bench.env("HTEX_BENCH_COMMAND", built.join("htex"));
    match python() {
        Some(python) => {
            bench.env("HTEX_BENCH_PYTHON", python);
        }
        None => eprintln!(
            "xtask: no Python with NumPy and SciPy: their rows stay empty. To have them:\n  \
             python3 -m venv target/peers && \
             target/peers/bin/pip install -r tests/peers/requirements.txt"
        ),
    }
    run(&mut bench)
}

/// Returns the Python of `target/peers`, or `python3`, if it has NumPy and SciPy.
#[must_use]
pub fn python() -> Option<PathBuf> {
    let own = target().join("peers/bin/python");
    [own, "python3".into()].into_iter().find(|python| {
        let mut imports = Command::new(python);
        imports.args(["-c", "import numpy, scipy"]);
        let quiet = imports.stdout(Stdio::null()).stderr(Stdio::null());
        quiet.status().is_ok_and(|status| status.success())
    })
}
