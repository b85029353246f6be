//! Runs the command on emulated processors, and tests that it writes the same files as here, byte
//! for byte.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

use super::{all_of, fixtures};
use crate::jobs::at_a_time;
use crate::places::{cargo, files, target, workspace};
use crate::plugins::models;
use crate::programs::{program, run};

/// Another architecture for which the command is built.
const AARCH64: &str = "aarch64-unknown-linux-musl";

/// Emulated x86-64 processors: one with AVX2, one with only AVX, and one without both.
const X86: [&str; 3] = ["Haswell-noTSX", "SandyBridge", "Nehalem"];

const SURFACES: [&str; 3] = ["vinyl", "corrugated-paper", "coarse-fabric"];

/// Compares the files for one surface, on the processors for which the command need not be built
/// again.
pub(super) fn sample(folder: &Path) -> Result<()> {
    same(folder, &SURFACES[..1], false)
}

pub(super) fn all(folder: &Path) -> Result<()> {
    same(folder, &SURFACES, true)
}

fn same(folder: &Path, surfaces: &[&str], with_aarch64: bool) -> Result<()> {
    let folder = fs_err::canonicalize(folder)?;
    let native = fixtures::command()?;
    let native = fs_err::canonicalize(&native)?;
    let expected = written(&folder.join("native"), std::slice::from_ref(&native), surfaces)?;
    let mut all: Vec<(String, Vec<PathBuf>)> = Vec::new();
    if cfg!(target_arch = "x86_64") {
        all.extend(X86.map(|cpu| {
            let under = ["qemu-x86_64", "-cpu", cpu].map(PathBuf::from);
            (cpu.to_owned(), [&under[..], std::slice::from_ref(&native)].concat())
        }));
    }
    if with_aarch64 || all.is_empty() {
        all.push(("aarch64".to_owned(), vec!["qemu-aarch64".into(), aarch64(&folder)?]));
    }
    let compared = at_a_time(2, all, |(name, command)| {
        let found = written(&folder.join(&name), &command, surfaces)?;
        let other = expected.iter().filter(|(file, bytes)| found.get(*file) != Some(bytes));
        let other: Vec<&str> = other.map(|(file, _)| &file[..]).collect();
        eprintln!("bindings: {name}: {} files, {} differ", expected.len(), other.len());
        ensure!(other.is_empty(), "{name}: {} differ", other.join(", "));
        Ok(())
    });
    all_of(compared)
}

/// Builds the command for another architecture with the Rust toolchain's own linker.
fn aarch64(folder: &Path) -> Result<PathBuf> {
    // In musl, libc contains all of libdl, and the target lacks the usual empty library with that
    // name.
    let empty = folder.join("libdl.a");
    fs_err::write(&empty, "!<arch>\n")?;
    let mut build = Command::new(cargo());
    build
        .args(["build", "--locked", "--package", "htex-cli", "--no-default-features"])
        .args(["--profile", "quick", "--target", AARCH64])
        .env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_MUSL_LINKER", "rust-lld")
        .env(
            "CARGO_TARGET_AARCH64_UNKNOWN_LINUX_MUSL_RUSTFLAGS",
            format!("-Lnative={}", folder.display()),
        )
        .env("CC_aarch64_unknown_linux_musl", "clang")
        .current_dir(workspace());
    run(&mut build).context("`rustup target add` brings the target")?;
    let built = target().join(AARCH64).join("quick/htex");
    Ok(fs_err::canonicalize(built)?)
}

/// Returns all files that a command writes: recordings, spectra, assets, samples of all models at
/// several motions, samples and a block that fluctuate, and samples of a scene.
fn written(
    folder: &Path,
    command: &[PathBuf],
    surfaces: &[&str],
) -> Result<BTreeMap<String, Vec<u8>>> {
    fs_err::create_dir_all(folder)?;
    let htex = |arguments: &[&str], out: Option<&str>| {
        let mut htex = program(&command[0], folder);
        htex.args(&command[1..]).args(arguments);
        let file = out.map(|out| fs_err::File::create(folder.join(out))).transpose()?;
        run(htex.stdout(file.map_or_else(Stdio::null, |file| file.into_file().into())))
    };
    for surface in surfaces {
        let [csv, asset] = ["csv", "htex"].map(|kind| format!("{surface}.{kind}"));
        htex(&["simulate", "--surface", surface, "-o", &csv], None)?;
        htex(&["process", &csv, "--json"], Some(&format!("{surface}.json")))?;
        let fit = ["fit", &csv, "--model", "all,arma,map", "-o", &asset];
        htex(&[&fit[..], &["--keep-reference"]].concat(), None)?;
        for model in &models()? {
            let out = format!("{surface}-{model}.wav");
            let what = ["synth", &asset, "--model", model, "--seconds", "1", "-o", &out];
            htex(
                &[&what[..], &["--rate", "44100", "--speed", "97", "--force", "0.3"]].concat(),
                None,
            )?;
        }
    }
    // A recording at another sample rate, whose segments have a prime length, and a fit to its
    // signals.
    htex(&["simulate", "--surface", "sandpaper", "--rate", "10015", "-o", "sandpaper.csv"], None)?;
    let burg = ["fit", "sandpaper.csv", "--model", "ar", "--option", "ar.method=burg"];
    htex(&[&burg[..], &["-o", "sandpaper.htex"]].concat(), None)?;
    // A texture that becomes stronger and weaker, as samples and as a block.
    let fluctuating = workspace().join("spec/conformance/valid_fluctuation.htex");
    let fluctuating = fs_err::canonicalize(fluctuating)?.to_string_lossy().into_owned();
    let long = ["--fluctuation", "--seconds", "5", "-o", "fluctuating.wav"];
    htex(&[&["synth", &fluctuating][..], &long].concat(), None)?;
    htex(&["bake", &fluctuating, "--fluctuation", "-o", "fluctuating.bin"], None)?;
    let scene = workspace().join("examples/scenes/two-swatches.scene.json");
    let scene = fs_err::canonicalize(scene)?;
    htex(&["render", &scene.to_string_lossy(), "-o", "scene.wav"], None)?;
    let read = |file: PathBuf| {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok((name, fs_err::read(&file)?))
    };
    files(folder)?.into_iter().map(read).collect()
}
