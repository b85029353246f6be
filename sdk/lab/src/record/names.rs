//! Names of the files of takes.

use std::path::{Path, PathBuf};

use crate::record::error::RecordError;

/// Folder for takes that left their target.
pub(crate) const REJECTED: &str = "rejected";
/// Folder for takes that were cut short.
pub(crate) const INCOMPLETE: &str = "incomplete";
/// Extension of the file for a take that is being recorded.
const PART: &str = "part";

/// Pattern of the names that [`check`] allows.
pub(crate) const PATTERN: &str = "^[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}$";

/// Returns the file name of a take without extension: `vinyl-007`.
pub(crate) fn stem(name: &str, number: u32) -> String {
    format!("{name}-{number:03}")
}

/// Returns the path of a take's part file.
pub(crate) fn part(folder: &Path, name: &str, number: u32) -> PathBuf {
    folder.join(format!("{}.{PART}", stem(name, number)))
}

/// Refuses names that cannot be part of a file name on every system.
pub(crate) fn check(name: &str) -> Result<(), RecordError> {
    let allowed = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'.');
    let is_sound = name.bytes().all(allowed) && !name.starts_with(['.', '-']);
    if is_sound && (1..=100).contains(&name.len()) {
        Ok(())
    } else {
        Err(RecordError::Setup {
            what: "the name of the takes",
            value: format!("{name:?}"),
            allowed: "it has 1 to 100 of the characters a-z, A-Z, 0-9, `_`, `-` and `.`, and begins with a letter, digit or `_`",
        })
    }
}

/// Returns the next free take number for this name. It counts all takes, whatever their outcome.
pub(crate) fn next_number(folder: &Path, name: &str) -> std::io::Result<u32> {
    let mut largest = 0;
    for folder in [folder.to_owned(), folder.join(REJECTED), folder.join(INCOMPLETE)] {
        largest = largest.max(largest_number(&files(&folder)?, name).unwrap_or(0));
    }
    Ok(largest.saturating_add(1))
}

/// Returns the largest number among the accepted takes with this name.
pub(crate) fn kept_number(folder: &Path, name: &str) -> Option<u32> {
    largest_number(&files(folder).ok()?, name)
}

fn largest_number(files: &[PathBuf], name: &str) -> Option<u32> {
    let stems = files.iter().filter_map(|file| file.file_stem());
    stems.filter_map(|stem| number(&stem.to_string_lossy(), name)).max()
}

fn number(stem: &str, name: &str) -> Option<u32> {
    stem.strip_prefix(name)?.strip_prefix('-')?.parse().ok()
}

/// Returns the part files of a folder, sorted by name.
pub(crate) fn parts(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    // Hidden files are unfinished ones of `OwnFolder`, and not takes.
    let is_part = |path: &PathBuf| {
        let is_hidden =
            path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        path.extension().is_some_and(|extension| extension == PART) && !is_hidden
    };
    let mut parts: Vec<PathBuf> = files(folder)?.into_iter().filter(is_part).collect();
    parts.sort();
    Ok(parts)
}

/// Returns the files of a folder; an empty list if there is no such folder.
fn files(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let entries = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    entries.map(|entry| Ok(entry?.path())).collect()
}
