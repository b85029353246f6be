//! Tests the Python package: builds its wheel, installs it into an empty environment, and runs its
//! tests there.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::places::files;
use crate::places::{target, workspace};
use crate::platform::Build;
use crate::programs::{program, run};

pub(super) fn test(folder: &Path) -> Result<()> {
    let folder = fs_err::canonicalize(folder)?;
    let python = environment(&folder, "test,lab")?;
    // Run outside the sources, so that the installed package is imported. The tests include the
    // examples in the README.
    let tests = package()?.join("tests");
    run(program(python, &folder)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider"])
        .arg(tests)
        .env("PYTHONDONTWRITEBYTECODE", "1"))
}

/// Builds the wheel and installs it, with an extra's dependencies, into an empty environment.
/// Returns the environment's interpreter.
pub(super) fn environment(folder: &Path, extra: &str) -> Result<PathBuf> {
    let venv = folder.join("venv");
    run(program("python3", folder).args(["-m", "venv"]).arg(&venv))?;
    let python = venv.join("bin/python");
    let pip = |arguments: &[&str]| {
        let mut pip = program(&python, folder);
        pip.args(["-m", "pip", "--disable-pip-version-check", "--quiet"]).args(arguments);
        pip
    };
    // Reuses the crates that were already built for the command and libhtex.
    let built = std::path::absolute(target())?;
    let build = Build::here()?;
    let mut maturin = build.profile().join(" ");
    if build.is_of_tests() {
        maturin.push_str(" --features pyo3/extension-module,like-tests");
    }
    run(pip(&["wheel", "--no-deps", "--wheel-dir", "wheel"])
        .arg(package()?)
        .env("MATURIN_PEP517_ARGS", maturin)
        .env("CARGO_TARGET_DIR", built))?;
    let wheels = files(&folder.join("wheel"))?;
    let wheel = wheels.first().context("pip wheel wrote no wheel")?;
    run(pip(&["install"]).arg(format!("{}[{extra}]", wheel.display())))?;
    Ok(python)
}

/// Returns the folder of the package's sources.
fn package() -> Result<PathBuf> {
    Ok(fs_err::canonicalize(workspace().join("sdk/bindings/python"))?)
}
