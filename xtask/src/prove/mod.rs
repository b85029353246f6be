//! `cargo xtask prove`: proofs that take too long for each run of continuous integration, which
//! runs samples of them.

mod outputs;
mod released;
mod targets;
mod ways;

use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::places::workspace;
use crate::programs::run;
use crate::{bindings, fuzz, places};

/// A proof: its name, what it takes, what it proves, and how.
struct Proof {
    name: &'static str,
    takes: &'static str,
    proves: &'static str,
    prove: fn(&[&str]) -> Result<()>,
}

const PROOFS: &[Proof] = &[
    Proof {
        name: "outputs",
        takes: "[--htex PATH]",
        proves: "prints hashes of what the command writes and prints; `diff` compares them with those of another build",
        prove: outputs::prove,
    },
    Proof {
        name: "fuzz",
        takes: "[options of cargo xtask fuzz]",
        proves: "no target of fuzz/fuzz_targets finds anything, each in ten minutes",
        prove: fuzz,
    },
    Proof {
        name: "targets",
        takes: "",
        proves: "libhtex compiles for Android, iOS and macOS, small and with scenes and libraries of textures; `rustup target add` brings the targets",
        prove: targets::prove,
    },
    Proof {
        name: "edges",
        takes: "",
        proves: "no reader fails for any extreme value, cell or byte of the seeds; tests take one of eleven",
        prove: |options| whole_test(options, &["--test", "edges"]),
    },
    Proof {
        name: "models",
        takes: "",
        proves: "every model passes the checker, native and as a module, with four seeds more, and each fault of a model fails one check of all",
        prove: |options| whole_test(options, &["--test", "command", "checker::"]),
    },
    Proof {
        name: "grids",
        takes: "",
        proves: "errors between the conditions of a free motion, of all models on all surfaces; tests take Bands on one",
        prove: |options| whole_test(options, &["--test", "grid"]),
    },
    Proof {
        name: "levels",
        takes: "",
        proves: "stored, copied and baked textures keep their level and their spectrum, of all surfaces and at recorded motions, too; \
                 tests take two surfaces and one motion",
        prove: |options| {
            whole_test(options, &["--test", "levels"])?;
            whole_test(options, &["--test", "command", "fit::"])?;
            whole_test(options, &["--test", "voices"])
        },
    },
    Proof {
        name: "scenes",
        takes: "",
        proves: "the planned chain has the samples of the full one in 2,000 scenes; tests take 250",
        prove: |options| whole_test(options, &["--test", "equivalence"]),
    },
    Proof {
        name: "recipes",
        takes: "",
        proves: "10,000 random recipes and tables in a folder with traps touch nothing outside the folder of results and request nothing, \
                 each within 512 MiB and 30 s; tests take 300",
        prove: |options| whole_test(options, &["--test", "command", "random_recipes::"]),
    },
    Proof {
        name: "fingers",
        takes: "",
        proves: "1,000 random scenes and studies put at most 1 V of direct voltage and the limit on a display, and zero within half a second; \
                 1,000 hostile programs at a page lose no answer and delay no press; tests take 20 and 60",
        prove: |options| {
            whole_test(options, &["--test", "live", "finger::random"])?;
            whole_test(options, &["--test", "live", "hostile_programs"])
        },
    },
    Proof {
        name: "zero",
        takes: "",
        proves: "whatever two of player, guardian, helpers, driver and card fail at any moments, with Ctrl-C at any other, a display is at zero \
                 0.5 s after the detection, or the sentence to switch the amplifier off is printed every second; tests take one failure",
        prove: |options| none(options).and_then(|()| cargo(&ZERO, &[(WHOLE, "1")])),
    },
    Proof {
        name: "days",
        takes: "[--hours N]",
        proves: "voices of a day keep their power and phase, and do not repeat; tests take an hour",
        prove: |options| cargo(&[&DAYS, options].concat(), &[]),
    },
    Proof {
        name: "processors",
        takes: "",
        proves: "the command writes the same bytes on four emulated processors; tests take one surface of three",
        prove: |options| none(options).and_then(|()| bindings::prove("processors")),
    },
    Proof {
        name: "bare",
        takes: "--release DIR [--processor aarch64]",
        proves: "the released archive and wheel for Linux work in an empty root of Debian without compilers, and programs in C find its libraries; \
                 another processor is emulated",
        prove: released::bare,
    },
    Proof {
        name: "bare-root",
        takes: "",
        proves: "nothing: makes the empty root of Debian that `bare` uses",
        prove: released::bare_root,
    },
    Proof {
        name: "wine",
        takes: "--release DIR",
        proves: "the released command and library for Windows work under Wine, with the samples of this machine, and programs in C find its libraries",
        prove: released::wine,
    },
    Proof {
        name: "ways",
        takes: "--release DIR [--only NAME] [--write]",
        proves: "every command of the pages in docs/ways runs on a released archive and wheel, and prints what the page says, each page within ten minutes",
        prove: ways::prove,
    },
    Proof {
        name: "costs",
        takes: "",
        proves: "prints what a sample costs in each language, against Rust",
        prove: |options| none(options).and_then(|()| bindings::prove("costs")),
    },
];

/// Without the rest of the workspace, so that it takes minutes.
const ZERO: [&str; 8] =
    ["test", "--locked", "-p", "htex-device-guardian", "--test", "zero", "--", "--nocapture"];

const DAYS: [&str; 8] = [
    "run",
    "--release",
    "-p",
    "htex-hard-cases",
    "--no-default-features",
    "--example",
    "long_runs",
    "--",
];

/// Tests that take a sample take all with this variable.
const WHOLE: &str = "HTEX_WHOLE";

/// Whether tests take all of what they else take a sample of.
pub fn whole() -> bool {
    std::env::var_os(WHOLE).is_some()
}

/// Runs the proof of a name; without one, lists all.
///
/// # Errors
/// What does not hold, or an unknown name.
pub fn prove(arguments: &[&str]) -> Result<()> {
    let Some((name, options)) = arguments.split_first() else {
        print!("{}", list());
        return Ok(());
    };
    let proof = PROOFS.iter().find(|proof| proof.name == *name);
    let proof = proof.with_context(|| format!("no proof `{name}`; there are\n{}", list()))?;
    (proof.prove)(options)
}

fn list() -> String {
    let line = |proof: &Proof| format!("{} {}\n    {}\n", proof.name, proof.takes, proof.proves);
    PROOFS.iter().map(line).collect()
}

fn none(options: &[&str]) -> Result<()> {
    ensure!(options.is_empty(), "{} is unknown", options.join(" "));
    Ok(())
}

fn fuzz(options: &[&str]) -> Result<()> {
    let options = match options {
        [] => &["--seconds", "600"],
        _ => options,
    };
    fuzz::fuzz(&fuzz::Options::parse(options)?)
}

/// A test with all of what it takes a sample of, of the same build as `cargo test`.
fn whole_test(options: &[&str], test: &[&str]) -> Result<()> {
    let test = [&["test", "--locked", "--workspace"], test, &["--", "--nocapture"]].concat();
    none(options).and_then(|()| cargo(&test, &[(WHOLE, "1"), ("HTEX_REQUIRE_WASM", "1")]))
}

fn cargo(arguments: &[&str], variables: &[(&str, &str)]) -> Result<()> {
    let mut cargo = Command::new(places::cargo());
    cargo.args(arguments).envs(variables.iter().copied());
    run(cargo.current_dir(workspace()))
}
