//! Makes the files of a release: archives for each platform, wheels, the npm package, lists of
//! their parts, and checksums.
//!
//! One machine builds for all platforms: zig builds everything against the C library of each
//! platform (for Windows, mingw-w64 does). The same sources must give the same bytes. Therefore
//! file times are the commit's time, and the result contains no path of this machine (see
//! `Build::cargo`; the module `tree` searches for such paths).

mod packages;
mod parts;
mod tree;
mod unity;

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use clap::Args;
use fs_err as fs;

use crate::commit::Commit;
use crate::places::workspace;
use crate::platform::{Build, PLATFORMS, Platform};
use crate::programs::{output, program, run};

/// What to write, and where.
#[derive(Debug, Args)]
pub struct Release {
    /// The folder to write to
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Parts to build: linux-x86_64, linux-aarch64, windows-x86_64, macos, npm or sdist [default:
    /// all]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    only: Vec<String>,
    /// Build for this machine, with its own tools, and without the lists of licences and parts
    #[arg(long)]
    trial: bool,
}

impl Release {
    /// Returns the platforms to build for.
    fn platforms(&self) -> Result<Vec<Platform>> {
        if self.only.is_empty() {
            return Ok(PLATFORMS.to_vec());
        }
        let names = self.only.iter().filter(|name| !["npm", "sdist"].contains(&&name[..]));
        names.map(|name| Platform::find(name)).collect()
    }

    fn has(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|one| one == name)
    }
}

/// Builds and writes the release.
///
/// # Errors
/// The error names the file or the program, or says what is missing and how to install it.
pub fn release(release: &Release) -> Result<()> {
    let platforms = release.platforms()?;
    let here = Platform::here()?;
    let is_here = platforms.iter().all(|one| *one == here);
    ensure!(is_here || !release.trial, "--trial: only {}", here.name);
    packages::check_tools(release.trial)?;
    fs::create_dir_all(&release.out)?;
    let out = fs::canonicalize(&release.out)?;
    let commit = match Commit::of_clone() {
        Err(_) if release.trial => Commit::unknown(),
        commit => commit?,
    };
    let version = crate::places::version()?;
    let kept = workspace().join("tests/compat").join(&version);
    ensure!(
        release.trial || kept.exists(),
        "{} is missing: its README says how the files of a version are kept",
        kept.display()
    );
    // Sources contain no third-party parts, so they need no list of licences.
    let is_compiled = release.has("npm") || !platforms.is_empty();
    let notices =
        if is_compiled && !release.trial { Some(parts::notices(&platforms)?) } else { None };
    let notices = notices.as_deref();
    for platform in &platforms {
        eprintln!("release: {}", platform.name);
        let build = if release.trial { Build::here()? } else { Build::release(*platform, &commit) };
        let folder = tree::lay_out(&build, &version, notices)?;
        packages::archive(&build, &folder, &out, &commit)?;
        if platform.has_wheel() {
            packages::wheel(&build, &out, notices)?;
        }
        if !release.trial {
            parts::bills(platform, &version, &out, &commit)?;
        }
    }
    unity::package(&platforms, &version, &out, &commit, notices)?;
    if release.has("npm") {
        packages::npm(&out, notices)?;
    }
    if release.has("sdist") {
        packages::sdist(&version, &out, &commit)?;
    }
    checksums(&out)
}

/// Writes `SHA256SUMS` for the files of a folder.
fn checksums(out: &Path) -> Result<()> {
    let mut names = Vec::new();
    for file in crate::places::files(out)? {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name != "SHA256SUMS" {
            names.push(name);
        }
    }
    names.sort();
    let sums = output(program("sha256sum", out).arg("--").args(&names))?;
    fs::write(out.join("SHA256SUMS"), sums)?;
    run(program("sha256sum", out).args(["--check", "--quiet", "SHA256SUMS"]))
}
