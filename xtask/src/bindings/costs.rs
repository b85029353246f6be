//! Measures the time per sample in each language, relative to Rust with blocks of the same length.
//! Rust and the other language take turns.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};

use super::copy;
use crate::dist::{Dist, dist};
use crate::places::{cargo, target, workspace};
use crate::platform::Build;
use crate::programs::{program, run};

// Odd, so that the median is one of the rounds.
const ROUNDS: usize = 15;
const MODELS: [&str; 2] = ["ar", "sbeta"];

/// Samples in a block of an audio thread.
const BLOCK: usize = 64;
/// Samples in a second, which scripts request at once.
const SECOND: usize = 20_000;

/// A language, the program that prints its time per sample, the number of samples per call, and the
/// largest allowed ratio to Rust's time.
struct Cost {
    language: &'static str,
    command: Vec<OsString>,
    samples: usize,
    most: f64,
}

pub(super) fn test(folder: &Path) -> Result<()> {
    let folder = fs_err::canonicalize(folder)?;
    let workspace = fs_err::canonicalize(workspace())?;
    let asset = workspace.join("examples/scenes/vinyl.htex");
    let (rust, all) = programs(&folder, &workspace)?;
    for model in MODELS {
        for cost in &all {
            let mut ratios = Vec::new();
            let mut least_ns = f64::INFINITY;
            // Both programs take turns, because the processor's clock changes from second to
            // second.
            for _ in 0..ROUNDS {
                let rust_ns = time_ns(&rust, cost.samples, model, &asset, &folder)?;
                let ns = time_ns(&cost.command, cost.samples, model, &asset, &folder)?;
                ratios.push(ns / rust_ns);
                least_ns = least_ns.min(ns);
            }
            ratios.sort_by(f64::total_cmp);
            let (ratio, most) = (ratios[ROUNDS / 2], cost.most);
            let over = if ratio > most { "  over the goal" } else { "" };
            println!(
                "{model:6} {:8} {:6} a call {least_ns:7.2} ns a sample  {ratio:5.3} of Rust, goal {most}{over}",
                cost.language, cost.samples
            );
        }
    }
    Ok(())
}

/// Returns the time per sample that a program prints.
fn time_ns(
    command: &[OsString],
    samples: usize,
    model: &str,
    asset: &Path,
    folder: &Path,
) -> Result<f64> {
    let mut measured = program(&command[0], folder);
    measured.args(&command[1..]).arg(asset).arg(model);
    measured.arg(samples.to_string());
    measured.env("LD_LIBRARY_PATH", folder.join("prefix/lib/whole"));
    measured.env("HTEX_PACKAGE", folder.join("htex"));
    let output = measured.output()?;
    let printed = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    let time = printed.trim().parse();
    time.with_context(|| format!("{command:?}: {printed}{errors}"))
}

/// Builds the programs: an example in Rust, and the programs in other languages.
fn programs(folder: &Path, workspace: &Path) -> Result<(Vec<OsString>, Vec<Cost>)> {
    let mut build = Command::new(cargo());
    build.args([
        "build",
        "--release",
        "--locked",
        "--package",
        "htex",
        "--example",
        "block",
        // The WASM engine is left out: linking it takes minutes, and only built-in models are
        // measured.
        "--no-default-features",
    ]);
    run(build.current_dir(workspace))?;
    let prefix = folder.join("prefix");
    dist(&Dist { prefix: prefix.clone(), whole: true, build: Build::here()? })?;
    crate::web::web(&folder.join("htex"))?;
    let costs = workspace.join("sdk/bindings/capi/tests/costs");
    let mut compile = program("cc", folder);
    compile.args(["-std=c11", "-O2", "-I"]).arg(prefix.join("include"));
    compile.arg(costs.join("block.c")).arg("-L").arg(prefix.join("lib/whole"));
    run(compile.args(["-lhtex", "-o", "block"]))?;
    let mut compile = program("mcs", folder);
    compile.args(["-optimize+", "-out:Block.exe"]).arg(costs.join("Block.cs"));
    run(compile.arg(prefix.join("share/htex/unity/Runtime/Htex.cs")))?;
    copy(&workspace.join("sdk/bindings/web/tests/block.mjs"), &folder.join("block.mjs"))?;
    let python = super::python::environment(folder, "test")?;
    let rust = fs_err::canonicalize(target().join("release/examples/block"))?;
    let words = |words: &[&str]| words.iter().map(OsString::from).collect();
    let cost = |language, command, samples, most| Cost { language, command, samples, most };
    let block = workspace.join("sdk/bindings/python/tests/costs/block.py");
    let python = vec![python.into(), block.into()];
    let all = vec![
        cost("C", words(&["./block"]), BLOCK, 1.02),
        cost("C#", words(&["mono", "Block.exe"]), BLOCK, 1.2),
        cost("Node.js", words(&["node", "block.mjs"]), BLOCK, 2.0),
        cost("Python", python, SECOND, 1.05),
    ];
    Ok((vec![rust.into()], all))
}
