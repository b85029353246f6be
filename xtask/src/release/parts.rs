//! What the released programs are made of: licences of others' code, and the bill of materials.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use fs_err as fs;

use crate::commit::Commit;
use crate::places::{cargo, release_trees, workspace};
use crate::platform::{Platform, tools_first};
use crate::programs::{program, run};

/// The name of the file with others' licences.
const NOTICES: &str = "THIRD-PARTY-NOTICES.txt";

/// Writes the licences of all packages that anything of the release is made of, with their texts; returns the file. It is one for all:
/// finding the texts takes minutes.
pub(super) fn notices(platforms: &[Platform]) -> Result<PathBuf> {
    let release = workspace().join("xtask/src/release");
    let to = std::path::absolute(release_trees().join(NOTICES))?;
    fs::create_dir_all(release_trees())?;
    let mut about = Command::new(cargo());
    about.args(["about", "generate", "--workspace", "--locked", "--offline"]);
    about.arg("--fail");
    let systems = platforms.iter().map(|one| one.triple);
    for target in systems.chain(std::iter::once(crate::web::TARGET)) {
        about.args(["--target", target]);
    }
    about.arg("--config").arg(release.join("about.toml"));
    about.arg("--output-file").arg(&to);
    about
        .arg(release.join("about.hbs"))
        .current_dir(workspace());
    run(about.env("PATH", tools_first()))?;
    Ok(to)
}

/// Copies them into a folder.
pub(super) fn put_notices(notices: &Path, folder: &Path) -> Result<()> {
    crate::dist::copy(notices, &folder.join(NOTICES))
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
