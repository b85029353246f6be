//! The user's own folders.

use std::env::var_os;
use std::path::PathBuf;

/// Returns the folder of cached files: `$HTEX_CACHE_DIR`, else `htex` in the user's cache folder.
pub fn cache() -> Option<PathBuf> {
    if let Some(own) = absolute("HTEX_CACHE_DIR") {
        return Some(own);
    }
    base("XDG_CACHE_HOME", ".cache").map(|base| base.join("htex"))
}

/// Returns the folder of settings: `$HTEX_CONFIG_DIR`, else `htex` in the user's configuration folder.
pub fn config() -> Option<PathBuf> {
    if let Some(own) = absolute("HTEX_CONFIG_DIR") {
        return Some(own);
    }
    base("XDG_CONFIG_HOME", ".config").map(|base| base.join("htex"))
}

/// Returns the folder of a user's plugins: `htex/plugins` in the user's data folder.
pub fn plugins() -> Option<PathBuf> {
    base("XDG_DATA_HOME", ".local/share").map(|base| base.join("htex/plugins"))
}

/// Returns a folder of the XDG base directory specification: that of the variable, else one in the home
/// folder; on Windows the local application data.
fn base(variable: &str, in_home: &str) -> Option<PathBuf> {
    let home = || absolute("HOME").map(|home| home.join(in_home));
    let windows = || absolute("LOCALAPPDATA").filter(|_| cfg!(windows));
    absolute(variable).or_else(windows).or_else(home)
}

/// Returns a variable's path; relative paths are ignored, as the specification requires.
fn absolute(variable: &str) -> Option<PathBuf> {
    let path = PathBuf::from(var_os(variable)?);
    path.is_absolute().then_some(path)
}
