//! Files that an installation keeps beside the command: pages that are built with Node.js, and
//! conformance files.

#[cfg(any(feature = "build", feature = "lab"))]
use std::path::Path;
use std::path::PathBuf;

use crate::failure::{Failure, Result};

/// The environment variable that names the folder of the pages.
#[cfg(any(feature = "build", feature = "lab"))]
const VARIABLE: &str = "HTEX_STUDIO";
/// Where an installation keeps the pages, relative to the folder of the command.
#[cfg(any(feature = "build", feature = "lab"))]
const SHARED: &str = "../share/htex/studio";

/// The environment variable that names the folder of the conformance files.
#[cfg(feature = "check")]
const CONFORMANCE: &str = "HTEX_CONFORMANCE";
/// Where an installation keeps the conformance files, relative to the folder of the command.
#[cfg(feature = "check")]
const SHARED_CONFORMANCE: &str = "../share/htex/conformance";

/// Returns the folder of the conformance files. `given` is the folder that the user names.
#[cfg(feature = "check")]
pub(crate) fn conformance(given: Option<PathBuf>) -> Result<PathBuf> {
    let named = given.or_else(|| std::env::var_os(CONFORMANCE).map(PathBuf::from));
    if let Some(folder) = named {
        return Ok(folder);
    }
    beside(SHARED_CONFORMANCE).filter(|folder| folder.is_dir()).ok_or_else(|| {
        Failure::Usage(format!(
            "the conformance files are not in {SHARED_CONFORMANCE}; give the folder `spec` of the sources by --files DIR or {CONFORMANCE}=DIR"
        ))
    })
}

/// Returns the first place with a page. `given` is the folder that the user names, and `find` looks
/// for the page in a folder.
#[cfg(any(feature = "build", feature = "lab"))]
pub(crate) fn page(
    given: Option<&Path>,
    what: &str,
    find: impl Fn(&Path) -> Option<PathBuf>,
) -> Result<PathBuf> {
    let given = given.map(Path::to_owned);
    let folder =
        given.or_else(|| std::env::var_os(VARIABLE).map(PathBuf::from)).or_else(|| beside(SHARED));
    folder.as_deref().and_then(&find).ok_or_else(|| {
        let place = folder.map_or(SHARED.to_owned(), |folder| folder.display().to_string());
        Failure::Other(format!(
            "{what} is not in {place}; build it by `cargo xtask studio --out DIR`, and give --folder DIR or set {VARIABLE}=DIR"
        ))
    })
}

/// Returns a folder of an installation, relative to the folder of the command.
fn beside(path: &str) -> Option<PathBuf> {
    let command = std::env::current_exe().ok()?;
    Some(command.parent()?.join(path))
}
