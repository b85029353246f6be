//! The user's folders for htex, and the native libraries in a folder.

use std::env::{consts::DLL_EXTENSION, split_paths, var_os};
use std::io;
use std::path::{Path, PathBuf};

/// Returns the folder for cached files: `$HTEX_CACHE_DIR`, or `htex` in the user's cache folder if
/// the variable is not set.
pub fn cache() -> Option<PathBuf> {
    absolute("HTEX_CACHE_DIR").or_else(|| Some(base("XDG_CACHE_HOME", ".cache")?.join("htex")))
}

/// Returns the folder for settings: `$HTEX_CONFIG_DIR`, or `htex` in the user's configuration
/// folder if the variable is not set.
pub fn config() -> Option<PathBuf> {
    absolute("HTEX_CONFIG_DIR").or_else(|| Some(base("XDG_CONFIG_HOME", ".config")?.join("htex")))
}

/// Environment variables that contain a single folder.
const VARIABLES: [&str; 6] = [
    "HTEX_CACHE_DIR",
    "HTEX_CONFIG_DIR",
    "XDG_CACHE_HOME",
    "XDG_CONFIG_HOME",
    "XDG_DATA_HOME",
    "HOME",
];

/// Returns the environment variables that name a folder of htex by a relative path, and these
/// paths. The other functions of this module ignore such variables.
pub fn relative() -> Vec<(&'static str, PathBuf)> {
    let path = |variable: &'static str| {
        let path = PathBuf::from(var_os(variable)?);
        let is_relative = !path.as_os_str().is_empty() && !path.is_absolute();
        is_relative.then_some((variable, path))
    };
    VARIABLES.into_iter().filter_map(path).collect()
}

/// Returns a folder in the user's data folder, if it exists, e.g. `htex/plugins` or
/// `htex/devices`.
pub fn data(folder: &str) -> Option<PathBuf> {
    data_or_new(folder).filter(|data| data.exists())
}

/// Returns a folder in the user's data folder as [`data`] does, even if the folder does not exist.
pub fn data_or_new(folder: &str) -> Option<PathBuf> {
    Some(base("XDG_DATA_HOME", ".local/share")?.join(folder))
}

/// Returns the existing folders of this name that all users of this machine share. They lie in the
/// folders of `$XDG_DATA_DIRS`, or in `/usr/local/share` and `/usr/share` if the variable is not
/// set. On Windows, the function looks in `%PROGRAMDATA%`; on macOS, it looks in
/// `/Library/Application Support`.
pub fn system(folder: &str) -> Vec<PathBuf> {
    let of_variable: Vec<PathBuf> =
        listed("XDG_DATA_DIRS").into_iter().filter(|dir| dir.is_absolute()).collect();
    let all = if !of_variable.is_empty() {
        of_variable
    } else if cfg!(windows) {
        absolute("PROGRAMDATA").into_iter().collect()
    } else if cfg!(target_os = "macos") {
        vec!["/Library/Application Support".into()]
    } else {
        vec!["/usr/local/share".into(), "/usr/share".into()]
    };
    all.into_iter().map(|dir| dir.join(folder)).filter(|dir| dir.exists()).collect()
}

/// Returns the folders that an environment variable lists, in the format of `PATH`.
pub fn listed(variable: &str) -> Vec<PathBuf> {
    let value = var_os(variable).unwrap_or_default();
    let folders = split_paths(&value).filter(|dir| !dir.as_os_str().is_empty());
    folders.collect()
}

/// Returns the native libraries in a folder and the files in it that have the extension `other`,
/// sorted by name.
///
/// # Errors
/// Returns an error if the folder cannot be read.
pub fn libraries_in(dir: &Path, other: Option<&str>) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(dir)? {
        let path = entry?.path();
        let extension = path.extension().and_then(|e| e.to_str());
        if extension.is_some() && (extension == Some(DLL_EXTENSION) || extension == other) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Returns a folder of the XDG base directory specification: the value of the variable, or a folder
/// in the home folder if the variable is not set. On Windows, returns the folder of local
/// application data.
fn base(variable: &str, in_home: &str) -> Option<PathBuf> {
    let home = || absolute("HOME").map(|home| home.join(in_home));
    let windows = || absolute("LOCALAPPDATA").filter(|_| cfg!(windows));
    absolute(variable).or_else(windows).or_else(home)
}

/// Returns the path in a variable. Relative paths are ignored, as the specification requires.
fn absolute(variable: &str) -> Option<PathBuf> {
    let path = PathBuf::from(var_os(variable)?);
    path.is_absolute().then_some(path)
}
