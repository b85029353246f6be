//! Lists the parts of the released programs: third-party licences, and the bill of materials.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use fs_err as fs;

use crate::commit::Commit;
use crate::places::{cargo, emptied, release_trees, workspace};
use crate::platform::{Platform, tools_first};
use crate::programs::{program, run};

/// Name of the file with third-party licences.
const NOTICES: &str = "THIRD-PARTY-NOTICES.txt";

/// Writes a file with the licences of all packages in the release, and their texts. Returns the
/// file. All parts of the release share it, because finding the texts takes minutes.
pub(super) fn notices(platforms: &[Platform]) -> Result<PathBuf> {
    let release = workspace().join("xtask/src/release");
    let to = std::path::absolute(release_trees().join(NOTICES))?;
    fs::create_dir_all(release_trees())?;
    let mut about = Command::new(cargo());
    about.args(["about", "generate", "--workspace", "--locked", "--offline"]);
    about.arg("--fail");
    // The modules of the npm package use packages that this machine's programs also use.
    let here = [Platform::here()?];
    let platforms = if platforms.is_empty() { &here } else { platforms };
    for platform in platforms {
        about.args(["--target", platform.triple]);
    }
    about.arg("--config").arg(release.join("about.toml"));
    about.arg("--output-file").arg(&to);
    about.arg(release.join("about.hbs")).current_dir(workspace());
    run(about.env("PATH", tools_first()))?;
    Ok(to)
}

/// Copies the licences into a folder.
pub(super) fn put_notices(notices: &Path, folder: &Path) -> Result<()> {
    crate::dist::copy(notices, &folder.join(NOTICES))
}

/// Writes the bills of materials for the command and for the wheel, in CycloneDX format. The tool
/// writes its files next to the manifests, so it gets a copy of the sources.
pub(super) fn bills(platform: &Platform, version: &str, out: &Path, commit: &Commit) -> Result<()> {
    let sources = sources()?;
    let mut billed = vec![("cli", "")];
    if platform.has_wheel() {
        billed.push(("sdk/bindings/python", "-python"));
    }
    for (package, of) in billed {
        let name = format!("htex-{version}{of}-{}.cdx", platform.name);
        let mut cyclonedx = Command::new(cargo());
        cyclonedx.args(["cyclonedx", "--quiet", "--format", "json"]);
        cyclonedx.args(["--spec-version", "1.5", "--target", platform.triple]);
        cyclonedx.args(["--manifest-path", &format!("{package}/Cargo.toml")]);
        cyclonedx.args(["--override-filename", &name]).current_dir(&sources);
        run(commit.told_to(cyclonedx.env("PATH", tools_first())))?;
        let name = format!("{name}.json");
        let text = fs::read_to_string(sources.join(package).join(&name))?
            .replace(&*sources.to_string_lossy(), "/htex");
        fs::write(out.join(&name), text)?;
    }
    Ok(())
}

/// Makes a copy of the committed sources.
fn sources() -> Result<PathBuf> {
    let folder = release_trees().join("sources");
    emptied(&folder)?;
    let archive = folder.join("sources.tar");
    let workspace = workspace();
    run(program("git", &workspace)
        .args(["archive", "--format=tar", "HEAD", "-o"])
        .arg(std::path::absolute(&archive)?))?;
    run(program("tar", &folder).args(["-xf", "sources.tar"]))?;
    fs::remove_file(archive)?;
    fs::canonicalize(folder).context("a copy of the sources")
}
