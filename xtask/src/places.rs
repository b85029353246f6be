//! Where cargo, the workspace and its target folder are.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// Returns the cargo that runs this program, or the cargo on the search path.
pub(crate) fn cargo() -> std::ffi::OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

pub(crate) fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

pub(crate) fn target() -> PathBuf {
    let own = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    // `join` replaces the workspace by an absolute path.
    workspace().join(own.unwrap_or_else(|| "target".into()))
}

/// Returns the folder in which the archives of a release are laid out.
pub(crate) fn release_trees() -> PathBuf {
    target().join("release-trees")
}

/// Returns the version of the workspace.
pub(crate) fn version() -> Result<String> {
    let text = fs_err::read_to_string(workspace().join("Cargo.toml"))?;
    let mut lines = text.lines();
    let version = lines.find_map(|line| line.strip_prefix("version = "));
    let version = version.context("Cargo.toml has no version")?;
    Ok(version.trim_matches('"').to_owned())
}

/// Makes an empty folder. Removes an existing folder with its contents.
pub(crate) fn emptied(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs_err::remove_dir_all(folder)?;
    }
    Ok(fs_err::create_dir_all(folder)?)
}

/// Returns the files in a folder.
pub(crate) fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs_err::read_dir(folder)?;
    let paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    Ok(paths.into_iter().filter(|path| path.is_file()).collect())
}
