//! Where cargo, the workspace and its target folder are.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// The cargo that runs this, else the one on the path.
pub(crate) fn cargo() -> std::ffi::OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

pub(crate) fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

pub(crate) fn target() -> PathBuf {
    let own = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    workspace().join(own.unwrap_or_else(|| "target".into()))
}

/// Where what goes into the archives of a release is laid out.
pub(crate) fn release_trees() -> PathBuf {
    target().join("release-trees")
}

/// The version of the workspace.
pub(crate) fn version() -> Result<String> {
    let text = fs_err::read_to_string(workspace().join("Cargo.toml"))?;
    let mut lines = text.lines();
    let version = lines.find_map(|line| line.strip_prefix("version = "));
    let version = version.context("Cargo.toml has no version")?;
    Ok(version.trim_matches('"').to_owned())
}

/// Makes a folder, without what it had.
pub(crate) fn emptied(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs_err::remove_dir_all(folder)?;
    }
    Ok(fs_err::create_dir_all(folder)?)
}

/// The files of a folder.
pub(crate) fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs_err::read_dir(folder)?;
    let paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    Ok(paths.into_iter().filter(|path| path.is_file()).collect())
}
