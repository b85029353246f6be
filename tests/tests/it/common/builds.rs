//! Third-party models, built from their sources.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use htex_host::LoadedModel;
use htex_tests::workspace;
use xtask::needs;

/// Where these tests keep what they build between runs.
const BUILDS: &str = env!("CARGO_TARGET_TMPDIR");
pub const WASM: &str = "wasm32-unknown-unknown";

pub fn has_clang() -> bool {
    let runs = |program| Command::new(program).arg("--version").output().is_ok();
    needs::WASM_CLANG.met(runs("clang") && runs("wasm-ld"))
}

pub fn has_wasm_target() -> bool {
    needs::WASM_TARGET.met(xtask::plugins::wasm_is_installed())
}

pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(BUILDS).join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs the `build.sh` of a project in C or Zig and returns what it built.
pub fn build_c(project: &Path, kind: &str) -> PathBuf {
    let mut build = Command::new("sh");
    build.arg(project.join("build.sh")).arg(kind);
    let built = run(build.env("ZIG", needs::zig().unwrap_or_default()));
    project.join(built.trim())
}

/// Builds a Rust project, for this machine or another target, and returns its library.
pub fn build_rust(project: &Path, target: Option<&str>) -> PathBuf {
    let folder = folder("third-party-target");
    let manifest = fs::read_to_string(project.join("Cargo.toml")).unwrap();
    let has_own = target.is_some() && manifest.contains("[profile.module]");
    let profile = if has_own { "module" } else { "release" };
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    run(Command::new(cargo)
        // In the project's folder, so that cargo reads the project's configuration.
        .current_dir(project)
        .args(["build", "--quiet", "--profile", profile, "--target-dir"])
        .arg(&folder)
        .args(target.iter().flat_map(|target| ["--target", target])));
    let name = manifest.split('"').nth(1).unwrap().replace('-', "_");
    let (prefix, suffix) = match target {
        Some(_) => ("", ".wasm"),
        None => (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX),
    };
    let library = format!("{prefix}{name}{suffix}");
    folder.join(target.unwrap_or_default()).join(profile).join(library)
}

/// Returns what a program prints, or its errors if it fails.
fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// A copy of the C example, ready to be built.
pub fn bursts_project() -> PathBuf {
    let project = folder("model-c-bursts");
    for file in ["bursts.c", "rhythm.h", "build.sh"] {
        let from = workspace().join("examples/model-c-bursts").join(file);
        let text = fs::read_to_string(from).unwrap();
        let root = workspace().canonicalize().unwrap();
        let text = text.replace("../..", root.to_str().unwrap());
        fs::write(project.join(file), text).unwrap();
    }
    project
}

/// The Rust example.
pub fn texel_project() -> PathBuf {
    workspace().join("examples/model-rust-texel")
}

/// Loads a model, which must be valid.
pub fn load(path: &Path) -> LoadedModel {
    LoadedModel::from_file(path).unwrap()
}
