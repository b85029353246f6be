//! Makes the Unity package with the libraries of all built platforms.

use std::path::Path;

use anyhow::Result;
use fs_err as fs;

use super::{packages, tree};
use crate::commit::Commit;
use crate::dist::unity;
use crate::places::release_trees;
use crate::platform::Platform;

/// Writes the package as a zip file, with the licences of the libraries' parts.
pub(super) fn package(
    platforms: &[Platform],
    version: &str,
    out: &Path,
    commit: &Commit,
    notices: Option<&Path>,
) -> Result<()> {
    if platforms.is_empty() {
        return Ok(());
    }
    let folder = release_trees().join(format!("htex-unity-{version}"));
    crate::places::emptied(&folder)?;
    let lib = |platform: &Platform| tree::folder(platform, version).join("lib/whole");
    let libraries: Vec<_> = platforms.iter().map(|one| (*one, lib(one))).collect();
    unity::package(&libraries, &folder)?;
    if let Some(all) = notices {
        let notices = folder.join("Third Party Notices.md");
        // In a code block, so that the text is not read as Markdown.
        let all = fs::read_to_string(all)?;
        let text = fs::read_to_string(&notices)?;
        fs::write(notices, format!("{text}\n~~~~~~text\n{all}~~~~~~\n"))?;
    }
    packages::zip(&folder, out, commit)
}
