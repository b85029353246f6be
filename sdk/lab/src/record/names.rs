//! Names of the files of takes.

use std::path::{Path, PathBuf};

use crate::record::error::RecordError;

/// Folder of takes that left their target.
pub(crate) const REJECTED: &str = "rejected";
/// Folder of takes that were cut short.
pub(crate) const INCOMPLETE: &str = "incomplete";
/// Extension of a take that is being recorded.
const PART: &str = "part";

/// The names that [`check`] allows.
pub(crate) const PATTERN: &str = "^[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}$";

/// The name of a take's files without extension: `vinyl-007`.
pub(crate) fn stem(name: &str, number: u32) -> String {
    format!("{name}-{number:03}")
}

/// The part file of a take.
pub(crate) fn part(folder: &Path, name: &str, number: u32) -> PathBuf {
    folder.join(format!("{}.{PART}", stem(name, number)))
}

/// Refuses names that are no part of a file name on every system.
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

/// The number after the largest of the takes of this name, whatever became of them.
pub(crate) fn next_number(folder: &Path, name: &str) -> std::io::Result<u32> {
    let mut largest = 0;
    for folder in [folder.to_owned(), folder.join(REJECTED), folder.join(INCOMPLETE)] {
        largest = largest.max(largest_number(&files(&folder)?, name).unwrap_or(0));
    }
    Ok(largest.saturating_add(1))
}

/// The largest number of the takes of this name that were kept.
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

/// Part files of a folder, in the order of their names.
pub(crate) fn parts(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let is_part = |path: &PathBuf| {
        let is_hidden =
            path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        path.extension().is_some_and(|extension| extension == PART) && !is_hidden
    };
    let mut parts: Vec<PathBuf> = files(folder)?.into_iter().filter(is_part).collect();
    parts.sort();
    Ok(parts)
}

/// Files of a folder; none if there is no such folder.
fn files(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let entries = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    entries.map(|entry| Ok(entry?.path())).collect()
}
