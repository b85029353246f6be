//! Makes the Unity package, with the libraries of several platforms.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use fs_err as fs;

use super::{copy, copy_folder};
use crate::places::workspace;
use crate::platform::{Platform, System};

/// The folder from which Unity imports libraries, and a folder that Unity ignores. The second one
/// holds the import settings of libraries that are not in the package.
const PLUGINS: &str = "Plugins";
const SET_ASIDE: &str = "Plugins~";

/// Writes the package into a folder. Takes each platform's library from its `lib` folder.
pub(crate) fn package(libraries: &[(Platform, PathBuf)], to: &Path) -> Result<()> {
    copy_folder(&workspace().join("sdk/bindings/capi/unity"), to)?;
    let plugins = to.join(PLUGINS);
    for (platform, lib) in libraries {
        if let Some((folder, name)) = plugin(*platform) {
            copy(&lib.join(name), &plugins.join(folder).join(name))?;
        }
    }
    set_aside(&plugins, to)
}

/// Returns the folder and the name of a platform's library. Unity has neither an editor nor a
/// player for Linux on ARM.
fn plugin(platform: Platform) -> Option<(&'static str, &'static str)> {
    match platform.name {
        "x86_64-linux" => Some(("Linux/x86_64", "libhtex.so")),
        "aarch64-linux" => None,
        _ if platform.system == System::Windows => Some(("Windows/x86_64", "htex.dll")),
        _ => Some(("macOS", "libhtex.dylib")),
    }
}

/// Moves each `NAME.meta` for which there is no NAME to the folder [`SET_ASIDE`], because Unity
/// would report NAME as missing. Removes empty folders.
fn set_aside(folder: &Path, package: &Path) -> Result<()> {
    for folder in entries(folder)?.iter().filter(|entry| entry.is_dir()) {
        set_aside(folder, package)?;
        // Checked only now, because moving its files may have emptied the folder.
        if entries(folder)?.is_empty() {
            fs::remove_dir(folder)?;
        }
    }
    for entry in entries(folder)? {
        let is_meta = entry.extension().is_some_and(|ending| ending == "meta");
        if is_meta && !entry.with_extension("").exists() {
            let below = entry.strip_prefix(package.join(PLUGINS))?;
            let to = package.join(SET_ASIDE).join(below);
            fs::create_dir_all(to.parent().context("a file has a folder")?)?;
            fs::rename(&entry, to)?;
        }
    }
    Ok(())
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder)?;
    let paths = entries.map(|entry| Ok(entry?.path()));
    Ok(paths.collect::<std::io::Result<_>>()?)
}
