//! What is released: archives for each platform, wheels, the npm package, lists of what they are
//! made of, and checksums.
//!
//! Everything is built by zig against the C library of each platform, that of Windows by mingw-w64,
//! so that one machine builds all. The same sources shall give the same bytes: times are those of
//! the commit, and no path of this machine is in what is built (`Build::cargo`; `tree` looks for
//! them).

mod packages;
mod parts;
mod tree;
mod unity;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};
use fs_err as fs;

use crate::commit::Commit;
use crate::places::workspace;
use crate::platform::{Build, PLATFORMS, Platform};
use crate::programs::{output, program, run};

/// What is written, and where.
pub struct Release {
    out: PathBuf,
    platforms: Vec<Platform>,
    npm: bool,
    sdist: bool,
    /// By this machine's tools, for this machine, and without the lists of what it is made of.
    is_trial: bool,
}

impl Release {
    /// Reads the words after `cargo xtask release`.
    ///
    /// # Errors
    /// A message with the words that are known.
    pub fn parse(words: &[&str]) -> Result<Self> {
        let (words, is_trial) = match words {
            [words @ .., "--trial"] => (words, true),
            words => (words, false),
        };
        let (out, only) = match *words {
            ["--out", out] => (out, None),
            ["--out", out, "--only", only] | ["--only", only, "--out", out] => (out, Some(only)),
            _ => bail!(
                "cargo xtask release --out DIR [--only NAME,…] [--trial], of {}, npm, sdist",
                PLATFORMS.map(|one| one.name).join(", ")
            ),
        };
        let mut release = Self {
            out: out.into(),
            platforms: Vec::new(),
            npm: only.is_none(),
            sdist: only.is_none(),
            is_trial,
        };
        match only {
            None => release.platforms = PLATFORMS.to_vec(),
            Some(only) => only.split(',').try_for_each(|name| release.add(name))?,
        }
        let here = Platform::here()?;
        let is_here = release.platforms.iter().all(|one| *one == here);
        ensure!(is_here || !is_trial, "--trial: only {}", here.name);
        Ok(release)
    }

    fn add(&mut self, name: &str) -> Result<()> {
        match name {
            "npm" => self.npm = true,
            "sdist" => self.sdist = true,
            _ => self.platforms.push(Platform::named(name)?),
        }
        Ok(())
    }
}

/// Builds and writes it.
///
/// # Errors
/// A message with the file or the program, and what is missing with how to install it.
pub fn release(release: &Release) -> Result<()> {
    packages::check_tools(release.is_trial)?;
    fs::create_dir_all(&release.out)?;
    let out = fs::canonicalize(&release.out)?;
    let commit = match Commit::of_clone() {
        Err(_) if release.is_trial => Commit::unknown(),
        commit => commit?,
    };
    let version = crate::places::version()?;
    let kept = workspace().join("tests/compat").join(&version);
    ensure!(
        release.is_trial || kept.exists(),
        "{} is missing: its README says how the files of a version are kept",
        kept.display()
    );
    let is_compiled = release.npm || !release.platforms.is_empty();
    let notices = if is_compiled && !release.is_trial {
        Some(parts::notices(&release.platforms)?)
    } else {
        None
    };
    let notices = notices.as_deref();
    for platform in &release.platforms {
        eprintln!("release: {}", platform.name);
        let build =
            if release.is_trial { Build::here()? } else { Build::release(*platform, &commit) };
        let folder = tree::lay_out(&build, &version, notices)?;
        packages::archive(&build, &folder, &out, &commit)?;
        if platform.has_wheel() {
            packages::wheel(&build, &out, notices)?;
        }
        if !release.is_trial {
            parts::bills(platform, &version, &out, &commit)?;
        }
    }
    unity::package(&release.platforms, &version, &out, &commit, notices)?;
    if release.npm {
        packages::npm(&out, notices)?;
    }
    if release.sdist {
        packages::sdist(&version, &out, &commit)?;
    }
    checksums(&out)
}

/// Writes `SHA256SUMS` of the files of a folder.
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
