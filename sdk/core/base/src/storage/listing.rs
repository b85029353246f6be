//! Lists files that match a pattern.

use std::path::Path;
use std::time::SystemTime;

use glob::{MatchOptions, Pattern};

use crate::storage::{Location, StorageError, StorageProblem};

/// Largest number of files in a list.
pub(crate) const MOST_ENTRIES: usize = 1_000_000;
/// Largest number of files that are examined for a list, whether they match or not.
pub(crate) const MOST_LISTED: usize = 10 * MOST_ENTRIES;
/// Largest nesting depth of folders.
const MOST_DEPTH: usize = 64;

/// A file in a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    pub location: Location,
    pub bytes: u64,
    /// The file's entity tag, if the store has one.
    pub etag: Option<String>,
    /// Time when the file's content last changed, if the store states it.
    pub modified: Option<SystemTime>,
}

/// Parses a pattern. `*` and `?` match within one folder, `**` matches across folders.
pub(crate) fn pattern(location: &Location, text: &str) -> Result<Pattern, StorageError> {
    Pattern::new(text).map_err(|error| {
        let problem = format!("the pattern {text}: {error}");
        StorageProblem::Uri { problem }.at_place(location)
    })
}

pub(crate) fn matches(pattern: &Pattern, relative: &str) -> bool {
    let options = MatchOptions { require_literal_separator: true, ..MatchOptions::new() };
    pattern.matches_with(relative, options)
}

pub(crate) fn too_many(location: &Location) -> StorageError {
    let problem = format!(
        "there are too many files: at most {MOST_ENTRIES} that match, of {MOST_LISTED}; name a folder or pattern with fewer"
    );
    StorageProblem::Uri { problem }.at_place(location)
}

/// Returns the files below a local folder whose relative names match. Links to folders are not
/// followed.
pub(crate) fn of_folder(folder: &Path, pattern: &Pattern) -> Result<Vec<Entry>, StorageError> {
    let mut found = Vec::new();
    let mut open = vec![(folder.to_owned(), 0)];
    let mut listed = 0;
    while let Some((path, depth)) = open.pop() {
        let shown = path.display();
        for entry in std::fs::read_dir(&path).map_err(StorageError::io_at(&shown))? {
            listed += 1;
            if listed > MOST_LISTED {
                return Err(too_many(&folder.to_owned().into()));
            }
            let entry = entry.map_err(StorageError::io_at(&shown))?;
            let (kind, path) =
                (entry.file_type().map_err(StorageError::io_at(&shown))?, entry.path());
            if kind.is_dir() && depth < MOST_DEPTH {
                open.push((path, depth + 1));
                continue;
            }
            let relative = path
                .strip_prefix(folder)
                .unwrap_or(&path)
                .to_string_lossy()
                .replace(std::path::MAIN_SEPARATOR, "/");
            // A file may have been removed since the folder was listed, and a link may lead
            // nowhere.
            let Ok(is) = path.metadata() else { continue };
            if !is.is_file() || !matches(pattern, &relative) {
                continue;
            }
            if found.len() == MOST_ENTRIES {
                return Err(too_many(&folder.to_owned().into()));
            }
            found.push(Entry {
                location: path.into(),
                bytes: is.len(),
                etag: None,
                modified: is.modified().ok(),
            });
        }
    }
    Ok(found)
}
