//! Runs one fuzz target.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use fs_err::{self as fs, File};

use super::report::Outcome;
use super::{Options, folder};

/// Longest input, bytes. Inputs are short, so that mutations are likely to hit parsed fields.
const LONGEST: u32 = 4096;
/// Longest time for one input, seconds.
const TIMEOUT_S: u32 = 10;
/// Memory limit, MiB.
const MEMORY_MIB: u32 = 1024;

/// Runs a target. Its output goes to `fuzz/logs`.
pub(super) fn run(programs: &Path, target: &str, options: &Options) -> Result<Outcome> {
    let at = |kind: &str| folder().join(kind).join(target);
    let (corpus, artifacts) = (at("corpus"), at("artifacts"));
    let log = folder().join("logs").join(format!("{target}.log"));
    for place in [&corpus, &artifacts, &folder().join("logs")] {
        fs::create_dir_all(place)?;
    }
    // Findings of an earlier run do not count for this run.
    let before = found(&artifacts);
    let mut program = Command::new(programs.join(target));
    program
        .arg(&corpus)
        .args(inputs(target))
        .arg(format!("-artifact_prefix={}/", artifacts.display()))
        .arg(format!("-max_len={LONGEST}"))
        .arg(format!("-timeout={TIMEOUT_S}"))
        .arg(format!("-rss_limit_mb={MEMORY_MIB}"))
        .args(["-print_final_stats=1", "-verbosity=1", "-use_value_profile=0"]);
    program.args(options.seconds.map(|seconds| format!("-max_total_time={seconds}")));
    program.args(options.executions.map(|most| format!("-runs={most}")));
    let dictionary = folder().join("dictionaries").join(format!("{target}.dict"));
    if dictionary.exists() {
        program.arg(format!("-dict={}", dictionary.display()));
    }
    let file = File::create(&log)?;
    let also = file.try_clone()?;
    let status = program
        .stdout(also.into_file())
        .stderr(file.into_file())
        .status()
        .with_context(|| target.to_owned())?;
    let text = String::from_utf8_lossy(&fs::read(&log)?).into_owned();
    let new = found(&artifacts).into_iter().find(|file| !before.contains(file));
    // If a run fails without an input, e.g. at its start, the finding is its log.
    let finding = (!status.success()).then(|| new.unwrap_or(log));
    Ok(Outcome::read(target, &text, finding))
}

/// Returns the folders of initial inputs, apart from the corpus of earlier runs.
fn inputs(target: &str) -> Vec<PathBuf> {
    let mut places = vec![
        folder().join("seeds").join(target),
        folder().join("../tests/regressions").join(target),
    ];
    match target {
        "open_asset" => places.push(folder().join("../spec/conformance")),
        "scene" => places.push(folder().join("../spec/scene-conformance")),
        _ => {}
    }
    places.retain(|place| place.is_dir());
    places
}

fn found(artifacts: &Path) -> Vec<PathBuf> {
    let files = fs::read_dir(artifacts).into_iter().flatten();
    files.flatten().map(|file| file.path()).collect()
}
