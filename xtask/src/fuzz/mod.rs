//! `cargo xtask fuzz`: builds the fuzz targets and runs each for a time.
//!
//! The programs are built as `cargo fuzz build --sanitizer none` builds them, and with the toolchain
//! that is installed: nothing here needs a nightly one or cargo-fuzz. The address sanitizer does.
//!
//! It is an option: unsafe code is in the shims of the ABIs alone. Coverage counters are a pass of the stable compiler.

mod build;
mod options;
mod report;
mod run;

use std::path::{Path, PathBuf};

pub use options::Options;

use crate::jobs::at_a_time;
use report::Outcome;

/// Builds and runs the chosen targets; true when nothing was found.
///
/// # Errors
/// When the programs cannot be built or run.
pub fn fuzz(options: &Options) -> Result<bool, String> {
    let targets = chosen(&options.targets)?;
    let programs = build::build(options)?;
    println!("{}", report::HEAD);
    let outcomes = at_a_time(options.jobs, targets, |target| {
        let outcome = run::run(&programs, &target, options)?;
        println!("{}", outcome.line());
        Ok(outcome)
    });
    let outcomes: Vec<Outcome> = outcomes.into_iter().collect::<Result<_, String>>()?;
    print!("{}", report::end(&outcomes));
    Ok(outcomes.iter().all(|outcome| outcome.finding.is_none()))
}

/// The folder `fuzz`.
fn folder() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).join("fuzz")
}

/// The targets of these names, or all: the files in `fuzz/fuzz_targets`.
fn chosen(wanted: &[String]) -> Result<Vec<String>, String> {
    let place = folder().join("fuzz_targets");
    let files = std::fs::read_dir(&place).map_err(|e| format!("{}: {e}", place.display()))?;
    let name = |path: PathBuf| Some(path.file_stem()?.to_str()?.to_owned());
    let mut all: Vec<String> = files
        .flatten()
        .filter_map(|file| name(file.path()))
        .collect();
    all.sort();
    if wanted.is_empty() {
        return Ok(all);
    }
    match wanted.iter().find(|name| !all.contains(name)) {
        None => Ok(wanted.to_vec()),
        Some(name) => Err(format!(
            "unknown target {name}; known are {}",
            all.join(", ")
        )),
    }
}
