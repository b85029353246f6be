//! What the released programs are made of: licences of others' code, and the bill of materials.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use fs_err as fs;

use crate::commit::Commit;
use crate::places::{cargo, release_trees, workspace};
use crate::platform::{Platform, tools_first};
use crate::programs::{program, run};

/// Writes the licences of all packages that the command and the whole library are made of, with their texts.
pub(super) fn notices(platform: &Platform, to: &Path) -> Result<()> {
    let release = workspace().join("xtask/src/release");
    let mut about = Command::new(cargo());
    about.args(["about", "generate", "--locked", "--offline", "--fail"]);
    about.args([
        "--manifest-path",
        "cli/Cargo.toml",
        "--target",
        platform.triple,
    ]);
    about.arg("--config").arg(release.join("about.toml"));
    about.arg("--output-file").arg(std::path::absolute(to)?);
    about
        .arg(release.join("about.hbs"))
        .current_dir(workspace());
    run(about.env("PATH", tools_first()))
}

/// Writes the bill of materials of the command in the format of CycloneDX. The program for it writes beside the manifests, so it has a copy of
/// the sources.
pub(super) fn bill(platform: &Platform, version: &str, out: &Path, commit: &Commit) -> Result<()> {
    let sources = sources()?;
    let name = format!("htex-{version}-{}.cdx", platform.name);
    let mut cyclonedx = Command::new(cargo());
    cyclonedx.args([
        "cyclonedx",
        "--quiet",
        "--format",
        "json",
        "--spec-version",
        "1.5",
    ]);
    cyclonedx.args([
        "--manifest-path",
        "cli/Cargo.toml",
        "--target",
        platform.triple,
    ]);
    cyclonedx
        .args(["--override-filename", &name])
        .current_dir(&sources);
    run(commit.told_to(cyclonedx.env("PATH", tools_first())))?;
    let name = format!("{name}.json");
    let text = fs::read_to_string(sources.join("cli").join(&name))?;
    let text = text.replace(&*sources.to_string_lossy(), "/htex");
    Ok(fs::write(out.join(&name), text)?)
}

/// A copy of what is committed.
fn sources() -> Result<PathBuf> {
    let folder = release_trees().join("sources");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let archive = folder.join("sources.tar");
    let workspace = workspace();
    run(program("git", &workspace)
        .args(["archive", "--format=tar", "HEAD", "-o"])
        .arg(std::path::absolute(&archive)?))?;
    run(program("tar", &folder).args(["-xf", "sources.tar"]))?;
    fs::remove_file(archive)?;
    fs::canonicalize(folder).context("a copy of the sources")
}
