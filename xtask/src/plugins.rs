//! Builds the models as plugins: native libraries and WASM modules.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use anyhow::{Result, anyhow};
use clap::ValueEnum;

use crate::needs;
use crate::places::{cargo, target, workspace};
use crate::programs::run;
pub use crate::wasm::Way;
use crate::wasm::{PROFILE, TARGET, Toolchain};

/// Returns the short names of the models in alphabetical order. They are the names of the folders
/// in `plugins`.
///
/// # Errors
/// When the folder cannot be read.
pub fn models() -> Result<Vec<String>> {
    let folders = fs_err::read_dir(workspace().join("plugins"))?;
    let names = folders.map(|one| Ok(one?.file_name().to_string_lossy().into_owned()));
    let mut models = names.collect::<Result<Vec<String>>>()?;
    models.sort();
    Ok(models)
}

/// Builds every model as a native library, and returns their folder, `htex-plugins` in the target
/// folder. cargo does not rebuild a library that is newer than its sources.
///
/// # Errors
/// The error names the model that could not be built. The compiler has printed the reason.
pub fn native() -> Result<PathBuf> {
    let target = target();
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    for model in &models()? {
        build(Command::new(cargo()), &target, model, &["--release"])?;
        let file = format!("{prefix}htex_{model}{suffix}");
        place(&target.join("release").join(&file), &file)?;
    }
    Ok(folder())
}

/// Builds every model as a WASM module, with the toolchain that `HTEX_WASM_TOOLCHAIN` names, and
/// returns the folder of the modules.
///
/// # Errors
/// The error says how to install a toolchain, or names the model that could not be built.
pub fn wasm() -> Result<PathBuf> {
    wasm_by(way()?)
}

/// Returns the toolchain that `HTEX_WASM_TOOLCHAIN` names.
fn way() -> Result<Way> {
    const NAME: &str = "HTEX_WASM_TOOLCHAIN";
    let way = std::env::var(NAME).ok().filter(|way| !way.is_empty());
    let way = way.map(|way| Way::from_str(&way, false).map_err(|error| anyhow!("{NAME}: {error}")));
    way.unwrap_or(Ok(Way::Auto))
}

/// As [`wasm`], with a given way of choosing the toolchain.
///
/// # Errors
/// As [`wasm`].
pub fn wasm_by(way: Way) -> Result<PathBuf> {
    let toolchain = Toolchain::find(way)?;
    for model in &models()? {
        let (cargo, target) = toolchain.cargo(&target());
        let profile = ["--profile", PROFILE];
        build(cargo, &target, model, &[&profile, toolchain.arguments()].concat())?;
        let file = format!("htex_{model}.wasm");
        place(&target.join(TARGET).join(PROFILE).join(&file), &file)?;
    }
    Ok(folder())
}

/// Whether the current toolchain builds WASM modules.
pub fn wasm_is_installed() -> bool {
    Toolchain::find(Way::Installed).is_ok()
}

/// Returns the folder of the WASM modules for a test. If no toolchain for WASM is installed,
/// returns `None`, and the test is listed as skipped at the end.
///
/// # Panics
/// When a model cannot be built, and as [`Need::met`](crate::needs::Need::met).
#[must_use]
#[allow(clippy::panic)] // It fails a test.
pub fn wasm_if_there() -> Option<PathBuf> {
    if !needs::WASM_TARGET.met(way().and_then(Toolchain::find).is_ok()) {
        return None;
    }
    Some(wasm().unwrap_or_else(|error| panic!("{error:#}")))
}

/// Returns the short names of the models that `htex fit` fits if the user names none, in
/// alphabetical order. Reads them from the descriptors in `spec/models`.
///
/// # Errors
/// As [`models`], and when a descriptor cannot be read.
pub fn fitted_by_default() -> Result<Vec<String>> {
    let mut fitted = Vec::new();
    for model in models()? {
        let file = workspace().join(format!("spec/models/org.htex.{model}.json"));
        let descriptor: serde_json::Value = serde_json::from_slice(&fs_err::read(file)?)?;
        if descriptor["only_named"] != true {
            fitted.push(model);
        }
    }
    Ok(fitted)
}

fn build(mut cargo: Command, target: &Path, model: &str, more: &[&str]) -> Result<()> {
    let package = format!("htex-{model}");
    run(cargo
        .args(["rustc", "--quiet", "--lib", "--package", &package])
        .args(more)
        // The manifests do not name the crate type `cdylib`, because programs also link the models.
        .args(["--features", "plugin", "--crate-type", "cdylib"])
        .env("CARGO_TARGET_DIR", target)
        .current_dir(workspace()))
}

/// Copies a built file to the plugin folder, through a temporary name and a rename.
fn place(built: &Path, name: &str) -> Result<()> {
    // Tests in several threads of one process place the same files.
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _held = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let (folder, beside) = (folder(), format!("{name}.{}", std::process::id()));
    fs_err::create_dir_all(&folder)?;
    // A test may have loaded the old file. Writing into a loaded library would crash its process.
    fs_err::copy(built, folder.join(&beside))?;
    Ok(fs_err::rename(folder.join(&beside), folder.join(name))?)
}

fn folder() -> PathBuf {
    target().join("htex-plugins")
}
