//! `cargo xtask prove`: proofs that take too long for each run of continuous integration, which
//! runs samples of them.

mod outputs;
mod released;
mod targets;
mod ways;

use std::process::Command;

use anyhow::Result;
use clap::Subcommand;

use crate::places::workspace;
use crate::programs::run;
use crate::{bindings, fuzz, places};

/// A proof and its options.
#[derive(Debug, Subcommand)]
pub enum Proof {
    /// Print hashes of what the command writes and prints, to compare two builds by `diff`
    Outputs(outputs::Options),
    /// No target of fuzz/fuzz_targets finds anything, each in ten minutes
    Fuzz(fuzz::Options),
    /// libhtex compiles for Android, iOS and macOS, small and with scenes and libraries of textures
    ///
    /// `rustup target add` brings the targets.
    Targets,
    /// No reader fails for any extreme value, cell or byte of the seeds; tests take one of eleven
    Edges,
    /// Every model passes the checker, native and as a module, with four more seeds
    ///
    /// Each fault of a model fails one check of all.
    Models,
    /// Errors between the conditions of a free motion, of all models on all surfaces
    ///
    /// Tests take Bands on one surface.
    Grids,
    /// Stored, copied and baked textures keep their level and their spectrum
    ///
    /// Takes all surfaces, also at recorded motions; tests take two surfaces and one motion.
    Levels,
    /// The planned chain has the samples of the full one in 2,000 scenes; tests take 250
    Scenes,
    /// 10,000 random recipes and tables touch nothing outside their folder of results
    ///
    /// They lie in a folder with traps. They request nothing, and each takes at most 512 MiB and 30
    /// s. Tests take 300.
    Recipes,
    /// 1,000 random scenes and studies, and 1,000 hostile programs at a page, harm no finger
    ///
    /// At most 1 V of direct voltage and the limit reach a display, and zero within half a second.
    /// The page loses no answer and delays no press. Tests take 20 and 60.
    Fingers,
    /// Any two failures leave zero at a display, or a sentence every second
    ///
    /// Player, guardian, helpers, driver and card fail at any moments, with Ctrl-C at any other.
    /// The display is at zero 0.5 s after the detection, or the sentence to switch the amplifier
    /// off is printed every second. Tests take one failure.
    Zero,
    /// Voices of a day keep their power and phase, and do not repeat; tests take an hour
    Days {
        #[arg(long, value_name = "N")]
        hours: Option<f64>,
    },
    /// The command writes the same bytes on four emulated processors
    ///
    /// Tests take one surface of three.
    Processors,
    /// The released archive and wheel for Linux work in an empty root of Debian
    ///
    /// The root has no compilers. Programs in C find the libraries; another processor is emulated.
    Bare(released::Bare),
    /// Make the empty root of Debian that `bare` uses; proves nothing
    BareRoot,
    /// The released command and library for Windows work under Wine
    ///
    /// They have the samples of this machine, and programs in C find the libraries.
    Wine(released::Folder),
    /// Every command of the pages in docs/ways runs on a released archive and wheel
    ///
    /// It prints what the page says, each page within ten minutes.
    Ways(ways::Options),
    /// Print what a sample costs in each language, against Rust
    Costs,
}

/// Without the rest of the workspace, so that it takes only minutes.
const ZERO: [&str; 9] = [
    "test",
    "--locked",
    "-p",
    "htex-device",
    "--test",
    "it",
    "guardian_zero::",
    "--",
    "--nocapture",
];

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

/// With this variable, tests that take a sample take everything.
const WHOLE: &str = "HTEX_WHOLE";

/// Whether tests take everything instead of a sample.
pub fn whole() -> bool {
    std::env::var_os(WHOLE).is_some()
}

/// Runs a proof.
///
/// # Errors
/// Which property does not hold.
pub fn prove(proof: &Proof) -> Result<()> {
    match proof {
        Proof::Outputs(options) => outputs::prove(options),
        Proof::Fuzz(options) => fuzz::fuzz(&options.bounded(600)),
        Proof::Targets => targets::prove(),
        Proof::Edges => whole_test("it", "edges::"),
        Proof::Models => whole_test("command", "checker::"),
        Proof::Grids => whole_test("it", "grid::"),
        Proof::Levels => {
            whole_test("it", "levels::")?;
            whole_test("command", "fit::")?;
            whole_test("it", "voices::")
        }
        Proof::Scenes => whole_test("it", "equivalence::"),
        Proof::Recipes => whole_test("command", "random_recipes::"),
        Proof::Fingers => {
            whole_test("live", "finger::random")?;
            whole_test("live", "hostile_programs")
        }
        Proof::Zero => cargo(&ZERO, &[(WHOLE, "1")]),
        Proof::Days { hours } => {
            let hours = hours.map(|hours| ["--hours".to_owned(), hours.to_string()]);
            let hours: Vec<&str> = hours.iter().flatten().map(String::as_str).collect();
            cargo(&[&DAYS, &hours[..]].concat(), &[])
        }
        Proof::Processors => bindings::prove("processors"),
        Proof::Bare(options) => released::bare(options),
        Proof::BareRoot => released::bare_root(),
        Proof::Wine(options) => released::wine(options),
        Proof::Ways(options) => ways::prove(options),
        Proof::Costs => bindings::prove("costs"),
    }
}

/// Runs the tests of these names on everything that they normally sample, in the same build as
/// `cargo test`.
fn whole_test(program: &str, tests: &str) -> Result<()> {
    let test = ["test", "--locked", "--test", program, tests, "--", "--nocapture"];
    cargo(&test, &[(WHOLE, "1"), ("HTEX_REQUIRE_WASM", "1")])
}

fn cargo(arguments: &[&str], variables: &[(&str, &str)]) -> Result<()> {
    let mut cargo = Command::new(places::cargo());
    cargo.args(arguments).envs(variables.iter().copied());
    run(cargo.current_dir(workspace()))
}
