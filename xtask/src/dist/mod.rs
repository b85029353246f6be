//! Installs libhtex: libraries, headers, C#, pkg-config and CMake files.
//!
//! The library in `lib` is small: it has no scenes, no libraries of textures and no WASM engine.
//! `lib/whole` has the library with all of these, under the same names. Both have the same
//! functions. A function that the small library does not support returns an error that says so.

mod links;
mod packages;
pub(crate) mod unity;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use fs_err as fs;

use crate::places::{version, workspace};
use crate::platform::{Build, System};
use crate::programs::run;

/// What to install, and where.
pub struct Dist {
    /// The folder to which `lib`, `include` and `share` are written.
    pub prefix: PathBuf,
    /// Whether to install the whole library next to the small one.
    pub whole: bool,
    pub build: Build,
}

/// Files in the header's folder.
const HEADERS: [&str; 2] = ["htex.h", "htex.hpp"];

/// Builds and installs.
///
/// # Errors
/// The error names the file or the program.
pub fn dist(options: &Dist) -> Result<()> {
    let Dist { prefix, build, .. } = options;
    let lib = prefix.join("lib");
    links::put(build, &build_small(build)?, &lib, false)?;
    if options.whole {
        links::put(build, &build_whole(build)?, &lib.join("whole"), true)?;
    }
    let source = workspace().join("sdk/bindings/capi");
    for header in HEADERS {
        let to = prefix.join("include").join(header);
        copy(&source.join("include").join(header), &to)?;
    }
    let of_unity = if options.whole { lib.join("whole") } else { lib.clone() };
    let unity = prefix.join("share/htex/unity");
    unity::package(&[(build.platform(), of_unity)], &unity)?;
    copy_folder(&source.join("fmod"), &prefix.join("share/htex/fmod"))?;
    packages::write(&lib, &version()?, build.platform().system, options.whole)
}

/// Builds the small library, and returns the folder of its files.
fn build_small(build: &Build) -> Result<PathBuf> {
    let mut command = build.cargo("build");
    command.args(["--locked", "--package", "htex-capi"]);
    run(command.args(["--profile", "small", "--no-default-features"]))?;
    Ok(build.output("small"))
}

/// Builds the whole library, and returns the folder of its files.
///
/// Builds the library together with the command and with the command's features, so that shared
/// dependencies are built only once. The readers of recordings are therefore also built, but not
/// linked, because nothing in the library calls them.
fn build_whole(build: &Build) -> Result<PathBuf> {
    run(build.cargo_of_both().args(of_command(build)))?;
    Ok(build.built())
}

/// Returns the command's features on a platform. Checking certificates through the system needs
/// Apple's frameworks, which only Apple's SDK contains.
pub(crate) fn of_command(build: &Build) -> &'static [&'static str] {
    const ALL_BUT_CLOUD: [&str; 3] = [
        "--no-default-features",
        "--features",
        "htex-cli/wasm,htex-cli/schemas,htex-cli/build,htex-cli/lab-files,htex-cli/lab,htex-cli/exchange,htex-cli/check,htex-cli/openxr,htex-cli/terminal,htex-capi/wasm,htex-capi/library,htex-capi/scene",
    ];
    match (build.is_release(), build.platform().system) {
        (true, System::MacOs) => &ALL_BUT_CLOUD,
        _ => &[],
    }
}

/// Copies a file. Creates the folder of the copy.
pub(crate) fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to.parent().context("a file has a folder")?)?;
    fs::copy(from, to)?;
    Ok(())
}

/// Copies the contents of a folder, with its subfolders.
fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let to = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &to)?;
        } else {
            copy(&entry.path(), &to)?;
        }
    }
    Ok(())
}
