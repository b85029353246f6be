//! Builds the studio from `sdk/bindings/studio`: one page, both as a single file and as a folder.

use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use fs_err as fs;

use crate::places::workspace;
use crate::programs::{program, run};

/// Where the page's build finds this workspace's npm package.
const PACKAGE: &str = ".htex";

/// The modules that `studio.html` contains. The module of imports contains the author module.
const MODULES: [&str; 2] = ["htex.wasm", "htex-import.wasm"];

/// Rounds of the compression, which take about 10 s. Three times as many save 0.01 %.
const ROUNDS: NonZeroU64 = NonZeroU64::new(5).expect("more than 0");

/// Builds `studio.html` and the folder `static` into a folder. Needs Rust, Node.js and npm.
///
/// # Errors
/// A message with the file or the program.
pub fn studio(out: &Path) -> Result<()> {
    let source = source();
    let package = source.join(PACKAGE);
    if package.exists() {
        fs::remove_dir_all(&package)?;
    }
    crate::web::web(&package)?;
    for name in MODULES {
        compress(&package.join(name))?;
    }
    install(&source)?;
    build(&source, out)
}

/// Writes a compressed copy of a file, `FILE.gz`. It is about 4 % smaller than one by zlib.
fn compress(file: &Path) -> Result<()> {
    let options = zopfli::Options { iteration_count: ROUNDS, ..Default::default() };
    let out = fs::File::create(file.with_added_extension("gz"))?;
    Ok(zopfli::compress(options, zopfli::Format::Gzip, fs::File::open(file)?, out)?)
}

/// Builds the page with the existing npm package.
pub(crate) fn build(source: &Path, out: &Path) -> Result<()> {
    fs::create_dir_all(out)?;
    run(program("npm", source).args(["run", "--silent", "build", "--"]).arg(fs::canonicalize(out)?))
}

/// Installs the npm packages that the lock file lists.
pub(crate) fn install(folder: &Path) -> Result<()> {
    run(program("npm", folder).args(["ci", "--silent", "--no-audit", "--no-fund"]))
        .context("Node.js from version 20 and npm build the studio")
}

pub(crate) fn source() -> PathBuf {
    workspace().join("sdk/bindings/studio")
}
