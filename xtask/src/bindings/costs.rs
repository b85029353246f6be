//! What a sample costs in each language, against Rust with blocks of the same length, in one run turn about.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use super::{copy, program, run};
use crate::dist::{Dist, dist};
use crate::places::{cargo, target, workspace};

const ROUNDS: usize = 5;
const MODELS: [&str; 2] = ["ar", "sbeta"];

/// Samples of a block of an audio thread, and of a second, which scripts ask for at once.
const LENGTHS: [usize; 2] = [64, 20_000];

/// A language, the program that prints its time, the samples of a call, and the most that it may cost.
struct Cost {
    language: &'static str,
    command: Vec<OsString>,
    samples: usize,
    most: f64,
}

pub(super) fn test(folder: &Path) -> Result<(), String> {
    let folder = std::fs::canonicalize(folder).map_err(|error| error.to_string())?;
    let workspace = std::fs::canonicalize(workspace()).map_err(|error| error.to_string())?;
    let asset = workspace.join("examples/scenes/vinyl.htex");
    let all = programs(&folder, &workspace)?;
    for model in MODELS {
        let mut least = vec![f64::INFINITY; all.len()];
        for _ in 0..ROUNDS {
            for (least, cost) in least.iter_mut().zip(&all) {
                let mut measured = program(&cost.command[0], &folder);
                measured.args(&cost.command[1..]).arg(&asset).arg(model);
                measured.arg(cost.samples.to_string());
                measured.env("LD_LIBRARY_PATH", folder.join("prefix/lib"));
                measured.env("HTEX_PACKAGE", folder.join("htex"));
                let output = measured.output().map_err(|error| error.to_string())?;
                let printed = String::from_utf8_lossy(&output.stdout);
                let ns: f64 = printed.trim().parse().map_err(|_| {
                    let errors = String::from_utf8_lossy(&output.stderr);
                    format!("{}: {printed}{errors}", cost.language)
                })?;
                *least = least.min(ns);
            }
        }
        for (ns, cost) in least.iter().zip(&all) {
            // The first rows are those of Rust.
            let rust = LENGTHS.iter().position(|length| *length == cost.samples);
            let (ratio, most) = (ns / least[rust.unwrap_or_default()], cost.most);
            let over = if ratio > most { "  over the goal" } else { "" };
            println!(
                "{model:6} {:8} {:6} a call {ns:7.2} ns a sample  {ratio:5.3} of Rust, goal {most}{over}",
                cost.language, cost.samples
            );
        }
    }
    Ok(())
}

/// Builds the programs; Rust is the first.
fn programs(folder: &Path, workspace: &Path) -> Result<Vec<Cost>, String> {
    let mut build = Command::new(cargo());
    build.args([
        "build",
        "--release",
        "--locked",
        "--package",
        "htex",
        "--example",
        "block",
        // Without the engine of modules, whose link takes minutes: built-in models are measured.
        "--no-default-features",
    ]);
    run(build.current_dir(workspace))?;
    let prefix = folder.join("prefix");
    dist(&Dist {
        prefix: prefix.clone(),
        small: false,
    })?;
    crate::web::web(&folder.join("htex"))?;
    let costs = workspace.join("sdk/capi/tests/costs");
    let mut compile = program("cc", folder);
    compile
        .args(["-std=c11", "-O2", "-I"])
        .arg(prefix.join("include"));
    compile
        .arg(costs.join("block.c"))
        .arg("-L")
        .arg(prefix.join("lib"));
    run(compile.args(["-lhtex", "-o", "block"]))?;
    let mut compile = program("mcs", folder);
    compile
        .args(["-optimize+", "-out:Block.exe"])
        .arg(costs.join("Block.cs"));
    run(compile.arg(prefix.join("share/htex/unity/Runtime/Htex.cs")))?;
    copy(
        &workspace.join("sdk/web/tests/block.mjs"),
        &folder.join("block.mjs"),
    )?;
    let python = super::python::environment(folder, "test")?;
    let rust = std::fs::canonicalize(target().join("release/examples/block"));
    let rust = rust.map_err(|error| error.to_string())?;
    let words = |words: &[&str]| words.iter().map(OsString::from).collect();
    let cost = |language, command, samples, most| Cost {
        language,
        command,
        samples,
        most,
    };
    let [block, second] = LENGTHS;
    let python = vec![
        python.into(),
        workspace.join("sdk/python/tests/costs/block.py").into(),
    ];
    Ok(vec![
        cost("Rust", vec![rust.clone().into()], block, 1.0),
        cost("Rust", vec![rust.into()], second, 1.0),
        cost("C", words(&["./block"]), block, 1.02),
        cost("C#", words(&["mono", "Block.exe"]), block, 1.2),
        cost("Node.js", words(&["node", "block.mjs"]), block, 2.0),
        cost("Python", python, second, 1.05),
    ])
}
