//! Files that an installation keeps beside the command: pages that are built with Node.js.

use std::path::{Path, PathBuf};

use crate::failure::{Failure, Result};

/// The environment variable that names the folder of the pages.
const VARIABLE: &str = "HTEX_STUDIO";
/// Where an installation keeps the pages, relative to the folder of the command.
const SHARED: &str = "../share/htex/studio";

/// Returns the first place with a page. `given` is the folder that the user names, and `find` looks
/// for the page in a folder.
pub(crate) fn page(
    given: Option<&Path>,
    what: &str,
    find: impl Fn(&Path) -> Option<PathBuf>,
) -> Result<PathBuf> {
    let given = given.map(Path::to_owned);
    let folder = given.or_else(|| std::env::var_os(VARIABLE).map(PathBuf::from)).or_else(shared);
    folder.as_deref().and_then(&find).ok_or_else(|| {
        let place = folder.map_or(SHARED.to_owned(), |folder| folder.display().to_string());
        Failure::Other(format!(
            "{what} is not in {place}; build it by `cargo xtask studio --out DIR`, and give --folder DIR or set {VARIABLE}=DIR"
        ))
    })
}

/// Returns the folder in which an installation keeps the pages.
fn shared() -> Option<PathBuf> {
    let command = std::env::current_exe().ok()?;
    Some(command.parent()?.join(SHARED))
}
