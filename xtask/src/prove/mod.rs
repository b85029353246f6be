//! `cargo xtask prove`: proofs that take too long for continuous integration. Its tests run only
//! samples of them.

mod apps;
mod outputs;
mod pages;
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
    /// Print hashes of all files and texts that the command writes, to compare two builds with
    /// `diff`
    Outputs(outputs::Options),
    /// Fuzz each target in fuzz/fuzz_targets for ten minutes; any finding is a failure
    Fuzz(fuzz::Options),
    /// Compile libhtex for Android, iOS and macOS, small and with scenes and libraries of textures
    ///
    /// `rustup target add` installs the targets.
    Targets,
    /// Run the fuzz targets on their seeds with every extreme value, cell and byte; tests take one
    /// input in eleven
    Edges,
    /// Check every model, native and as a WASM module; checks of sounds run with four more seeds
    ///
    /// Also shows, for each known fault of a model, that exactly one check fails.
    Models,
    /// Measure the errors between the conditions of a free motion, for all models on all surfaces
    ///
    /// Tests take only the model Bands on one surface.
    Grids,
    /// Show that stored, copied and baked textures keep their level and their spectrum
    ///
    /// Takes all five surfaces, and plays at a recorded motion and between recorded motions. Tests
    /// take two surfaces, and play only between recorded motions.
    Levels,
    /// Show that the planned chain of stages gives the samples of the full chain, in 2,000 scenes;
    /// tests take 100
    Scenes,
    /// Build 10,000 random recipes and tables, which must touch nothing outside their folder of
    /// results
    ///
    /// The recipes are in a folder with traps. They must request nothing from a network, and each
    /// may take at most 512 MiB and 30 s. Tests take 300.
    Recipes,
    /// Show that 1,000 random scenes and studies, and 1,000 hostile programs at a page, harm no
    /// finger
    ///
    /// The voltage at the display stays within its limit, with at most 1 V of direct voltage, and
    /// reaches zero within half a second. The page of a study loses no answer and delays no press.
    /// Tests take 20 scenes and studies, and 60 programs.
    Fingers,
    /// Show that after any two failures a display is at zero, or a warning is printed every second
    ///
    /// Player, guardian, helper processes, driver and card fail at any time, and Ctrl-C comes at
    /// any time. Half a second after the failure is detected, either the display is at zero, or the
    /// player says every second to switch the amplifier off. Tests take one failure.
    Zero,
    /// Show that voices keep their power and phase over a day, and do not repeat; tests take an
    /// hour
    Days {
        #[arg(long, value_name = "N")]
        hours: Option<f64>,
    },
    /// Show that the command writes the same bytes on four emulated processors
    ///
    /// Tests take one of three surfaces.
    Processors,
    /// Test the released archive and wheel for Linux in an empty root of Debian
    ///
    /// The root has no compilers. Programs in C must find the libraries. QEMU emulates the
    /// processor if it is not this machine's.
    Bare(released::Bare),
    /// Make the empty root of Debian that `bare` uses; proves nothing
    BareRoot,
    /// Test the released command and library for Windows under Wine
    ///
    /// They must write the same samples as on this machine, and programs in C must find the
    /// libraries.
    Wine(released::Folder),
    /// Run every command of the pages in docs/ways on a released archive and wheel
    ///
    /// Each command must print what its page says, and each page may take at most ten minutes.
    Ways(ways::Options),
    /// Build the example apps in Rust (examples/app-rust-*), and run the commands of their READMEs
    ///
    /// Each app is a copy in a folder outside the workspace. Linux needs libasound2-dev and
    /// pkg-config. The proof takes some minutes, and about 1 GB in target/examples.
    Apps(apps::Options),
    /// Test the studio in every window, in light and in dark; tests take two windows
    Studio,
    /// Print the time per sample in each language, relative to Rust
    Costs,
}

/// Builds without the rest of the workspace, so that it takes only minutes.
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

/// If this variable is set, tests that otherwise take a sample take everything.
pub(crate) const WHOLE: &str = "HTEX_WHOLE";

/// Whether tests take everything instead of a sample.
pub fn whole() -> bool {
    std::env::var_os(WHOLE).is_some()
}

/// Runs a proof.
///
/// # Errors
/// The error says which property does not hold.
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
        Proof::Apps(options) => apps::prove(options),
        Proof::Studio => bindings::prove("studio"),
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
