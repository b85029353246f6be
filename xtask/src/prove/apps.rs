//! Builds and runs the example apps in Rust as their READMEs say, outside the repository.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use clap::Args;
use fs_err as fs;

use super::pages::{follow, link};
use crate::places::{cargo, emptied, target, workspace};
use crate::programs::{program, run};

/// The beginning of the names of the apps' folders in `examples`.
const APP: &str = "app-rust-";

#[derive(Debug, Args)]
pub struct Options {
    /// Replace the output in the READMEs by what the commands print
    #[arg(long)]
    write: bool,
}

/// Copies each app, checks it with clippy, and runs the commands of its README.
pub(super) fn prove(options: &Options) -> Result<()> {
    let place = std::path::absolute(target().join("apps"))?;
    prepare(&place)?;
    // Uses one folder for all apps, so that the apps share the crates that several of them use.
    let built = std::path::absolute(target().join("examples"))?;
    let variables =
        [("CARGO_TARGET_DIR", built.as_os_str()), ("CARGO_PROFILE_DEV_DEBUG", "0".as_ref())];
    for app in apps()? {
        let begin = Instant::now();
        let folder = copy(&app, &place)?;
        let mut clippy = program(cargo(), &folder);
        clippy.args(["clippy", "--quiet", "--locked", "--all-targets", "--", "-D", "warnings"]);
        run(clippy.envs(variables))?;
        follow(&format!("examples/{app}/README.md"), &folder, &variables, options.write)?;
        let is_same =
            fs::read(folder.join("Cargo.lock"))? == fs::read(original(&app).join("Cargo.lock"))?;
        ensure!(is_same, "examples/{app}/Cargo.lock is not up to date");
        println!("examples/{app}: {:.1} s", begin.elapsed().as_secs_f64());
    }
    Ok(())
}

/// Returns the names of the apps' folders.
fn apps() -> Result<Vec<String>> {
    let entries = fs::read_dir(workspace().join("examples"))?;
    let names = entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
    let mut names = names.collect::<Result<Vec<_>>>()?;
    names.retain(|name| name.starts_with(APP));
    names.sort_unstable();
    Ok(names)
}

fn original(app: &str) -> PathBuf {
    workspace().join("examples").join(app)
}

/// Makes a folder with the files that the commands of the apps read.
fn prepare(place: &Path) -> Result<()> {
    emptied(&place.join("examples"))?;
    let sources = fs::canonicalize(workspace())?;
    for files in ["examples/scenes", "sdk"] {
        let at = place.join(files);
        if !at.exists() {
            link(&sources.join(files), &at)?;
        }
    }
    // Clippy would otherwise take the settings of htex from a folder above.
    Ok(fs::write(place.join("clippy.toml"), "")?)
}

/// Copies an app, and returns its folder. The copy takes the crate `htex` from the sources.
fn copy(app: &str, place: &Path) -> Result<PathBuf> {
    let folder = place.join("examples").join(app);
    fs::create_dir_all(&folder)?;
    let files = ["Cargo.toml", "Cargo.lock", "src", "tests"].map(|file| original(app).join(file));
    let files = files.iter().filter(|file| file.exists());
    run(Command::new("cp").arg("-R").args(files).arg(&folder))?;
    let manifest = folder.join("Cargo.toml");
    let text = fs::read_to_string(&manifest)?;
    let sources = fs::canonicalize(workspace())?;
    let sources = sources.to_str().context("the path of the sources is not UTF-8")?;
    fs::write(manifest, text.replace("\"../../", &format!("\"{sources}/")))?;
    Ok(folder)
}
