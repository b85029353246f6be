//! Tests the bindings to other languages, which need more than Rust: `cargo xtask bindings`.

mod c;
mod costs;
mod exchanged;
mod fixtures;
mod processors;
mod python;
mod studio;
mod web;

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

pub use fixtures::command;

use crate::jobs::at_a_time;
use crate::places::{cargo, emptied, target, workspace};
use crate::platform::Build;
use crate::programs::run;

/// A binding: its name, the programs that its tests need, and the tests.
struct Binding {
    name: &'static str,
    needs: &'static [Program],
    test: fn(&Path) -> Result<()>,
}

/// A program and how to install it.
struct Program {
    /// Its name, or several alternative names.
    names: &'static [&'static str],
    how: &'static str,
}

const CC: Program = Program { names: &["cc"], how: "apt-get install gcc" };
const CLANG: Program = Program { names: &["clang"], how: "apt-get install clang lld" };
const PKG_CONFIG: Program = Program { names: &["pkg-config"], how: "apt-get install pkg-config" };
const CMAKE: Program = Program { names: &["cmake"], how: "apt-get install cmake" };
const SDL2: Program = Program { names: &["sdl2-config"], how: "apt-get install libsdl2-dev" };
const MONO: Program = Program { names: &["mono"], how: "apt-get install mono-mcs mono-runtime" };
const NODE: Program = Program { names: &["node"], how: "install Node.js from version 20" };
const NPM: Program = Program { names: &["npm"], how: "apt-get install npm" };
const PYTHON: Program =
    Program { names: &["python3"], how: "apt-get install python3 python3-venv" };
const CHROMIUM: Program = Program {
    names: &["chromium", "chromium-browser", "google-chrome"],
    how: "apt-get install chromium",
};
const QEMU_USER: [Program; 2] = [
    Program { names: &["qemu-x86_64"], how: "apt-get install qemu-user" },
    Program { names: &["qemu-aarch64"], how: "apt-get install qemu-user" },
];

const BINDINGS: [Binding; 6] = [
    Binding { name: "c", needs: &[CC, PKG_CONFIG, CMAKE, SDL2], test: c::test },
    Binding { name: "python", needs: &[PYTHON], test: python::test },
    Binding { name: "web", needs: &[NODE, NPM, CHROMIUM, CLANG], test: web::test },
    Binding { name: "studio", needs: &[NODE, NPM, CHROMIUM], test: studio::test },
    Binding { name: "processors", needs: &QEMU_USER, test: processors::sample },
    Binding { name: "test-programs", needs: &[], test: test_programs },
];

/// Proofs that take too long for the tests of continuous integration.
const PROOFS: [Binding; 3] = [
    Binding { name: "processors", needs: &QEMU_USER, test: processors::all },
    Binding { name: "studio", needs: &[NODE, NPM, CHROMIUM], test: studio::all },
    Binding { name: "costs", needs: &[CC, MONO, NODE, PYTHON], test: costs::test },
];

/// Tests the named bindings, or all of them.
///
/// # Errors
/// The error says what is missing, or which test failed. The test has already printed its own
/// output.
pub fn test(names: &[String]) -> Result<()> {
    let known = BINDINGS.map(|binding| binding.name);
    if let Some(name) = names.iter().find(|name| !known.contains(&&name[..])) {
        bail!("no binding `{name}`; there are {}", known.join(", "));
    }
    let named =
        |binding: &&Binding| names.is_empty() || names.iter().any(|name| name == binding.name);
    // Two tests run at a time on two cores. With three at a time, a browser cannot render its sound
    // in time.
    let tested = at_a_time(2, BINDINGS.iter().filter(named).collect(), Binding::test);
    all_of(tested)
}

/// Builds the test programs of the workspace if they share a profile with the programs that are
/// tested here, as in continuous integration. There is time for this build, because browser tests
/// mostly wait and the last ones run alone.
fn test_programs(_: &Path) -> Result<()> {
    if !Build::here()?.is_of_tests() {
        return Ok(());
    }
    let mut build = Command::new("nice");
    build.arg(cargo()).args(["test", "--locked", "--no-run"]).current_dir(workspace());
    run(&mut build)
}

/// Combines several errors into one.
fn all_of(tested: Vec<Result<()>>) -> Result<()> {
    let errors = tested.into_iter().filter_map(Result::err);
    let errors: Vec<String> = errors.map(|error| format!("{error:#}")).collect();
    ensure!(errors.is_empty(), "{}", errors.join("\n"));
    Ok(())
}

/// Runs the proof with this name in full. The tests of continuous integration run only a sample of
/// it.
///
/// # Errors
/// As [`test`].
pub(crate) fn prove(name: &str) -> Result<()> {
    let proof = PROOFS.iter().find(|proof| proof.name == name);
    proof.map_or(Ok(()), Binding::test)
}

impl Binding {
    fn test(&self) -> Result<()> {
        let name = self.name;
        let missing: Vec<String> = self.needs.iter().filter_map(Program::missing).collect();
        ensure!(missing.is_empty(), "{name}: {}", missing.join("; "));
        eprintln!("bindings: {name}");
        let folder = target().join("bindings").join(name);
        let tested = emptied(&folder).and_then(|()| (self.test)(&folder));
        tested.context(name)
    }
}

impl Program {
    /// Returns the first of the names for which a program is installed.
    fn find(&self) -> Option<&'static str> {
        // It is enough that the program starts: not every program knows `--version`.
        let there = |name: &&&str| Command::new(name).arg("--version").output().is_ok();
        self.names.iter().find(there).copied()
    }

    /// Returns what is missing, and how to install it.
    fn missing(&self) -> Option<String> {
        let names = self.names.join(" or ");
        match self.find() {
            Some(_) => None,
            None => Some(format!("{names} is missing ({})", self.how)),
        }
    }
}

/// Returns the path of a program.
fn which(name: &str) -> std::path::PathBuf {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let mut all = std::env::split_paths(&path).map(|folder| folder.join(name));
    all.find(|file| file.is_file()).unwrap_or_else(|| name.into())
}

/// Copies a file to a path.
fn copy(from: &Path, to: &Path) -> Result<()> {
    fs_err::copy(from, to)?;
    Ok(())
}
