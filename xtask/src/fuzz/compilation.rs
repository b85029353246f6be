//! Building the fuzz targets.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use crate::programs::run;

use super::{Options, folder};

/// Flags for coverage counters, the same as in cargo-fuzz.
const COVERAGE: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing -Ccodegen-units=1";

/// Builds the programs of targets, and returns their folder.
pub(super) fn build(options: &Options, targets: &[String]) -> Result<PathBuf> {
    let host = host()?;
    let (flags, place) = if options.address {
        (format!("{COVERAGE} -Zsanitizer=address"), "address")
    } else {
        (COVERAGE.to_owned(), "none")
    };
    let place = target_folder().join(place);
    let mut cargo = cargo(options.address);
    // With `--target`, these flags do not apply to build scripts and macros.
    cargo
        .args(["build", "--release", "--locked", "--target", &host])
        .args(targets.iter().flat_map(|target| ["--bin", target]))
        .arg("--target-dir")
        .arg(&place)
        .env("RUSTFLAGS", flags)
        .current_dir(folder());
    run(&mut cargo).context(if options.address {
        "the targets cannot be built with the address sanitizer; it needs a nightly toolchain: \
             `rustup toolchain install nightly --profile minimal`, or leave --address out"
    } else {
        "the targets cannot be built; libFuzzer needs a C++ compiler (`apt-get install g++`)"
    })?;
    Ok(place.join(host).join("release"))
}

/// Returns the cargo that runs this task, or the cargo of the nightly toolchain.
fn cargo(nightly: bool) -> Command {
    if nightly {
        let mut cargo = Command::new("cargo");
        // Otherwise the variables that the current toolchain has set would override `+nightly`.
        cargo.env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO").env_remove("RUSTC");
        cargo.arg("+nightly");
        return cargo;
    }
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Returns the folder for the builds. It is not the folder of `cargo fuzz`, which uses other flags.
fn target_folder() -> PathBuf {
    match std::env::var_os("CARGO_TARGET_DIR") {
        Some(place) => PathBuf::from(place).join("fuzz"),
        None => folder().join("target/xtask"),
    }
}

/// Returns the target triple of this machine.
fn host() -> Result<String> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc).arg("-vV").output().context("cannot run rustc")?;
    let text = String::from_utf8_lossy(&output.stdout);
    let host = text
        .lines()
        .find_map(|line| line.strip_prefix("host: "))
        .context("rustc does not say what it builds for")?;
    Ok(host.to_owned())
}
