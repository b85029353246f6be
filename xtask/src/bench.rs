//! The benchmark beside plain loops in C and Python libraries.

use std::path::PathBuf;
use std::process::{Command, ExitCode, Stdio};

/// Builds the benchmark and the command, finds Python, and runs the benchmark.
pub fn run(options: &[&str]) -> ExitCode {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut build = Command::new(&cargo);
    build.args(["build", "--release", "-p", "htex-bench", "-p", "htex-cli"]);
    match build.status() {
        Ok(status) if status.success() => {}
        Ok(_) => return ExitCode::FAILURE,
        Err(error) => {
            eprintln!("xtask: {cargo}: {error}");
            return ExitCode::FAILURE;
        }
    }
    let built = crate::places::target().join("release");
    let mut bench = Command::new(built.join("htex-bench"));
    bench.args(options);
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
    match bench.status() {
        Ok(status) if status.success() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("xtask: {}: {error}", built.join("htex-bench").display());
            ExitCode::FAILURE
        }
    }
}

/// The Python of `target/peers`, else `python3`, if it has NumPy and SciPy.
fn python() -> Option<PathBuf> {
    let own = crate::places::target().join("peers/bin/python");
    [own, "python3".into()].into_iter().find(|python| {
        let mut imports = Command::new(python);
        imports.args(["-c", "import numpy, scipy"]);
        let quiet = imports.stdout(Stdio::null()).stderr(Stdio::null());
        quiet.status().is_ok_and(|status| status.success())
    })
}
