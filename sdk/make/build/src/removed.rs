//! Textures that the library contained before this build and no longer contains after the build.
//!
//! It is not an error if a glob matches fewer files than in the last build. If a folder is moved,
//! the textures from recordings in this folder are therefore removed from the library. The build
//! reports the removals or, if the options forbid removals, stops with an error.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use htex_base::storage::{Location, Storage};
use htex_format::library::Library;

use crate::assemble::{MOST_REPORT_BYTES, REPORT_FILE, previous};
use crate::dist::Dist;
use crate::report::{Report, Status};

/// Largest number of names in a message.
const NAMED: usize = 3;

/// Returns the names of the textures in the library that the last build wrote. It reads the report
/// of that build and the library's own index. If the local folder has neither, it may be a new
/// folder for remote results, and the function reads the remote report.
pub(crate) fn textures_before(
    dist: &Dist,
    library: &str,
    remote: Option<&Location>,
) -> BTreeSet<String> {
    let report = previous(dist);
    let before = library_before(dist, library);
    let entries = before.iter().flat_map(Library::entries);
    let mut names: BTreeSet<String> =
        entries.map_while(Result::ok).map(|entry| entry.name).collect();
    names.extend(report.iter().flat_map(built));
    if names.is_empty() {
        names.extend(remote.and_then(report_at).iter().flat_map(built));
    }
    names
}

/// Returns the names of the textures that are in the library according to a report.
pub(crate) fn built(report: &Report) -> impl Iterator<Item = String> {
    let built = report.textures.iter().filter(|t| t.status == Status::Built);
    built.map(|texture| texture.name.clone()).chain(report.kept.iter().cloned())
}

/// Opens the library that the last build wrote. If the file is missing or damaged, there is no
/// library, and the build writes the file again.
pub(crate) fn library_before(dist: &Dist, library: &str) -> Option<Library> {
    let file = previous(dist).map(|report| report.library.file);
    // The report may come from somebody else, so the file that it names must lie in this folder.
    let is_name = |file: &String| !file.contains(['/', '\\']) && file.ends_with(".htexlib");
    let file = file.filter(is_name).unwrap_or_else(|| format!("{library}.htexlib"));
    let is_file = |path: &Path| path.symlink_metadata().is_ok_and(|at| at.is_file());
    let path = dist.path_of(Path::new(&file)).ok().filter(|path| is_file(path))?;
    Library::open(&path).ok()
}

/// Reads the report at a URI.
fn report_at(location: &Location) -> Option<Report> {
    let storage = Storage::from_environment().ok()?;
    let bytes = storage.read(&location.inside(REPORT_FILE), MOST_REPORT_BYTES).ok()?;
    serde_json::from_slice(&bytes).ok()
}

/// Lists texture names briefly. Several names in the same folder are shortened to the folder:
/// `hatt/…`.
///
/// ```
/// let names = ["hatt/cork", "hatt/felt", "oak"].map(str::to_owned);
/// assert_eq!(htex_build::named_briefly(&names), "hatt/…, oak");
/// ```
#[must_use]
pub fn named_briefly(names: &[String]) -> String {
    let folder = |name: &'_ String| name.rsplit_once('/').map(|(folder, _)| folder.to_owned());
    let mut folders: BTreeMap<String, usize> = BTreeMap::new();
    for name in names.iter().filter_map(folder) {
        *folders.entry(name).or_default() += 1;
    }
    let word = |name: &String| match folder(name) {
        Some(folder) if folders.get(&folder) > Some(&1) => format!("{folder}/…"),
        _ => name.clone(),
    };
    let words: BTreeSet<String> = names.iter().map(word).collect();
    let mut words: Vec<String> = words.into_iter().collect();
    let more = words.len() > NAMED;
    words.truncate(NAMED);
    words.extend(more.then(|| "…".to_owned()));
    words.join(", ")
}
