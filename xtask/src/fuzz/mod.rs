//! `cargo xtask fuzz`: builds the fuzz targets and runs each for a limited time.
//!
//! Builds the programs in the same way as `cargo fuzz build --sanitizer none`, but with the
//! installed toolchain. Needs neither a nightly toolchain nor cargo-fuzz. Only the address
//! sanitizer needs a nightly toolchain.
//!
//! The sanitizer is optional, because only the shims of the ABIs contain unsafe code. The coverage
//! counters need no sanitizer: they are a pass of the stable compiler.

mod compilation;
mod options;
mod report;
mod run;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};
pub use options::Options;

use crate::jobs::at_a_time;
use report::Outcome;

/// Default time limit of a target, seconds.
const SECONDS: u64 = 60;

/// Builds and runs the chosen targets.
///
/// # Errors
/// When the programs cannot be built or run, or when fuzzing has found something.
pub fn fuzz(options: &Options) -> Result<()> {
    let options = &options.bounded(SECONDS);
    let targets = chosen(&options.targets)?;
    let programs = compilation::build(options, &targets)?;
    println!("{}", report::HEAD);
    let outcomes = at_a_time(options.jobs as usize, targets, |target| {
        let outcome = run::run(&programs, &target, options)?;
        println!("{}", outcome.line());
        Ok(outcome)
    });
    let outcomes: Vec<Outcome> = outcomes.into_iter().collect::<Result<_>>()?;
    print!("{}", report::end(&outcomes));
    let clean = outcomes.iter().all(|outcome| outcome.finding.is_none());
    ensure!(clean, "fuzzing found something");
    Ok(())
}

/// The folder `fuzz`.
fn folder() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).join("fuzz")
}

/// Returns the targets with these names, or all targets if there are no names. Targets are the
/// files in `fuzz/fuzz_targets`.
fn chosen(wanted: &[String]) -> Result<Vec<String>> {
    let files = fs_err::read_dir(folder().join("fuzz_targets"))?;
    let name = |path: PathBuf| Some(path.file_stem()?.to_str()?.to_owned());
    let mut all: Vec<String> = files.flatten().filter_map(|file| name(file.path())).collect();
    all.sort();
    if wanted.is_empty() {
        return Ok(all);
    }
    if let Some(name) = wanted.iter().find(|name| !all.contains(name)) {
        bail!("unknown target {name}; known are {}", all.join(", "));
    }
    Ok(wanted.to_vec())
}
