//! What a block of 64 samples costs in each language, against Rust, in one run turn about.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use super::{copy, program, run};
use crate::dist::{Dist, dist};
use crate::places::{cargo, target, workspace};

const ROUNDS: usize = 5;
const MODELS: [&str; 2] = ["ar", "sbeta"];

/// A language, the program that prints its time, and the most that it may cost.
struct Cost {
    language: &'static str,
    command: Vec<OsString>,
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
            let (ratio, most) = (ns / least[0], cost.most);
            let over = if ratio > most { "  over the goal" } else { "" };
            println!(
                "{model:6} {:8} {ns:7.2} ns a sample  {ratio:5.3} of Rust, goal {most}{over}",
                cost.language
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
    let rust = std::fs::canonicalize(target().join("release/examples/block"));
    let words = |words: &[&str]| words.iter().map(OsString::from).collect();
    Ok(vec![
        Cost {
            language: "Rust",
            command: vec![rust.map_err(|e| e.to_string())?.into()],
            most: 1.0,
        },
        Cost {
            language: "C",
            command: words(&["./block"]),
            most: 1.02,
        },
        Cost {
            language: "C#",
            command: words(&["mono", "Block.exe"]),
            most: 1.2,
        },
        Cost {
            language: "Node.js",
            command: words(&["node", "block.mjs"]),
            most: 2.0,
        },
    ])
}
