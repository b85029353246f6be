//! The Unity package with the libraries of all platforms that are built.

use std::path::Path;

use anyhow::Result;
use fs_err as fs;

use super::{packages, tree};
use crate::commit::Commit;
use crate::dist::unity;
use crate::places::release_trees;
use crate::platform::Platform;

/// Writes it as a zip file.
pub(super) fn package(
    platforms: &[Platform],
    version: &str,
    out: &Path,
    commit: &Commit,
) -> Result<()> {
    if platforms.is_empty() {
        return Ok(());
    }
    let folder = release_trees().join(format!("htex-unity-{version}"));
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let lib = |platform: &Platform| tree::folder(platform, version).join("lib/whole");
    let libraries: Vec<_> = platforms.iter().map(|one| (*one, lib(one))).collect();
    unity::package(&libraries, &folder)?;
    packages::zip(&folder, out, commit)
}
