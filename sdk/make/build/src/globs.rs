//! Finds local and remote files by glob.
//!
//! Globs are in recipes, and a recipe may come from anyone. The library that compiles globs is
//! recursive, so a long or deeply nested glob could exhaust the stack. Therefore this module limits
//! the length and the braces of a glob. It also limits the number of folder entries that are
//! examined for a glob.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};

use globset::{GlobBuilder, GlobSet, GlobSetBuilder};
use htex_base::files::FileError;
use htex_base::storage::Location;
use walkdir::WalkDir;

use crate::BuildError;
use crate::error::at_place;
use crate::remote::joined;

/// Characters that make a text a glob.
const GLOB: [char; 4] = ['*', '?', '[', '{'];
/// Longest glob, bytes.
const MOST_BYTES: usize = 4096;
/// Largest number of alternatives in a glob, and their largest nesting depth.
const MOST_BRACES: usize = 64;
const MOST_NESTED: usize = 8;
/// Largest number of globs in a list.
const MOST_GLOBS: usize = 1024;
/// Largest number of folder entries that are examined for one glob.
const MOST_ENTRIES: usize = 2_000_000;

/// Compiles globs. `*` does not match across folders, `**` does.
pub(crate) fn glob_set<S: AsRef<str>>(globs: &[S], place: &str) -> Result<GlobSet, BuildError> {
    if globs.len() > MOST_GLOBS {
        let problem = format!("it has {} globs and the most is {MOST_GLOBS}", globs.len());
        return Err(BuildError::at_place(place, problem));
    }
    let mut set = GlobSetBuilder::new();
    for glob in globs {
        check(glob.as_ref()).map_err(at_place(place))?;
        let compiled = GlobBuilder::new(glob.as_ref()).literal_separator(true).build();
        set.add(compiled.map_err(at_place(place))?);
    }
    set.build().map_err(at_place(place))
}

fn check(glob: &str) -> Result<(), String> {
    if glob.len() > MOST_BYTES {
        return Err(format!(
            "a glob has {} bytes and the most is {MOST_BYTES}; shorten it",
            glob.len()
        ));
    }
    let (mut open, mut most, mut all) = (0_usize, 0, 0);
    // Escaped braces count too, which only makes the limit stricter.
    for c in glob.chars() {
        match c {
            '{' => (open, all) = (open + 1, all + 1),
            '}' => open = open.saturating_sub(1),
            _ => {}
        }
        most = open.max(most);
    }
    if all > MOST_BRACES || most > MOST_NESTED {
        Err(format!(
            "a glob has {all} braces, {most} within each other, and the most are {MOST_BRACES} and {MOST_NESTED}; write several globs"
        ))
    } else {
        Ok(())
    }
}

/// Returns whether a text is a glob. The query of a URL and its host are ignored, because a query
/// starts with `?` and a host may be in brackets.
pub(crate) fn is_glob(text: &str) -> bool {
    let path = path_of(text);
    text[path].contains(GLOB)
}

/// Returns which part of a text is a path. The path of a URI excludes scheme and host; the path of
/// a URL also excludes the query.
fn path_of(text: &str) -> Range<usize> {
    let Some(host) = text.find("://").map(|at| at + 3) else {
        return 0..text.len();
    };
    let start = text[host..].find('/').map_or(text.len(), |at| host + at);
    let end = if text[..host].to_ascii_lowercase().starts_with("http") {
        text[start..].find('?').map_or(text.len(), |at| start + at)
    } else {
        text.len()
    };
    start..end
}

/// Splits a path or a URI into a folder and a glob in that folder. It is split before the first
/// part with a glob, or else before the file's name.
pub(crate) fn split(text: &str) -> (&str, &str) {
    let path = path_of(text);
    let first = text[path.clone()].find(GLOB).map_or(path.end, |at| path.start + at);
    match text[..first].rfind('/') {
        Some(0) => ("/", &text[1..]),
        Some(slash) => (&text[..slash], &text[slash + 1..]),
        None => ("", text),
    }
}

/// Returns the local files that match a glob. The glob comes from a recipe in `folder`. If it is
/// relative, the files are relative to the folder; otherwise they are absolute. Files in `output`
/// are left out.
pub(crate) fn files(
    glob: &str,
    place: &str,
    folder: &Path,
    output: &Path,
) -> Result<Vec<PathBuf>, BuildError> {
    // A `file://` URI is also a local path, and its escapes must be resolved.
    let location = Location::parse(glob.as_ref())?;
    let path = location.local().map(Path::to_string_lossy).unwrap_or(glob.into());
    let (base, pattern) = split(&path);
    let base = normalised(Path::new(base));
    let walked = joined(folder, &base);
    if !walked.is_dir() {
        return Ok(Vec::new());
    }
    let set = glob_set(&[pattern], place)?;
    let output = output.canonicalize().ok();
    let is_output = |entry: &walkdir::DirEntry| {
        let is = || output.is_some() && entry.path().canonicalize().ok() == output;
        entry.file_type().is_dir() && is()
    };
    let mut walk = WalkDir::new(&walked).follow_links(true);
    // Without `**`, no deeper folder can match.
    if !pattern.contains("**") {
        walk = walk.max_depth(pattern.split('/').count());
    }
    let (mut found, mut seen) = (Vec::new(), 0);
    for entry in walk.into_iter().filter_entry(|entry| !is_output(entry)) {
        seen += 1;
        if seen > MOST_ENTRIES {
            let problem = format!(
                "{glob}: more than {MOST_ENTRIES} entries of folders to look at; name a folder with fewer"
            );
            return Err(BuildError::at_place(place, problem));
        }
        let entry = match entry {
            // A link that leads nowhere, or to a folder above it, contains no recordings.
            Err(error) if error.path().is_some_and(Path::is_symlink) => continue,
            Err(error) => {
                let file = error.path().unwrap_or(folder).to_owned();
                return Err(FileError::reading(file, error).into());
            }
            Ok(entry) => entry,
        };
        let inside = entry.path().strip_prefix(&walked).unwrap_or(entry.path());
        if entry.file_type().is_file() && set.is_match(inside) {
            found.push(base.join(inside));
        }
    }
    Ok(found)
}

/// Returns a path without `.`, in which each `..` is resolved.
fn normalised(path: &Path) -> PathBuf {
    let mut parts: Vec<Component<'_>> = Vec::new();
    for part in path.components() {
        match (part, parts.last()) {
            (Component::CurDir, _) => {}
            (Component::ParentDir, Some(Component::Normal(_))) => drop(parts.pop()),
            // The folder above the root is the root.
            (Component::ParentDir, Some(Component::RootDir)) => {}
            _ => parts.push(part),
        }
    }
    parts.iter().collect()
}

/// Returns the paths in a remote folder that match a glob.
pub(crate) fn matching(
    paths: Vec<(PathBuf, PathBuf)>,
    pattern: &str,
    place: &str,
) -> Result<Vec<(PathBuf, PathBuf)>, BuildError> {
    let set = glob_set(&[pattern], place)?;
    let mut seen = BTreeSet::new();
    let matching =
        paths.into_iter().filter(|(uri, inside)| set.is_match(inside) && seen.insert(uri.clone()));
    Ok(matching.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn globs_are_split_before_their_first_glob() {
        for (text, folder, pattern) in [
            ("rec/*.csv", "rec", "*.csv"),
            ("*.csv", "", "*.csv"),
            ("../a/b{1,2}/*.csv", "../a", "b{1,2}/*.csv"),
            ("/*.csv", "/", "*.csv"),
            ("s3://bucket/*.csv", "s3://bucket", "*.csv"),
            ("s3://bucket/a/b.csv", "s3://bucket/a", "b.csv"),
            ("https://h/a.csv?s=/x*", "https://h", "a.csv?s=/x*"),
            ("http://[::1]:80/a/b.csv", "http://[::1]:80/a", "b.csv"),
        ] {
            assert_eq!(split(text), (folder, pattern), "{text}");
        }
        assert!(!is_glob("http://[::1]/a.csv?x=*") && is_glob("https://h/*.csv"));
        assert_eq!(normalised("./a/../../b/.".as_ref()), Path::new("../b"));
        assert_eq!(normalised("/../b".as_ref()), Path::new("/b"));
    }

    #[test]
    fn what_would_recurse_too_deep_is_refused() {
        for glob in ["{".repeat(50_000), "{".repeat(9), "{a,b}".repeat(65)] {
            assert!(glob_set(&[glob], "here").is_err());
        }
        assert!(glob_set(&["{a,{b,c}}*/**/[x-z]?.csv"], "here").is_ok());
    }
}
