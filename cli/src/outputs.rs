//! Protects a command's inputs from being overwritten by its outputs.
//!
//! Files are compared by device and inode before the command starts, so that an input is recognised
//! under any other name.

use std::fs::Metadata;
use std::path::Path;

use crate::failure::{Failure, Result};
use crate::output::shown;

/// Refuses an output that is also an input, and two outputs that are the same file, even under
/// different names.
///
/// Does not report inputs that do not exist; the code that reads them does.
pub(crate) fn check_outputs<'a>(
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<()> {
    let inputs: Vec<&Path> = inputs.into_iter().collect();
    let mut before: Vec<&Path> = Vec::new();
    for output in outputs {
        if inputs.iter().any(|input| is_same(input, output)) {
            return Err(Failure::Usage(format!(
                "{}: it is read here, and would be lost; name another file to write",
                shown(output)
            )));
        }
        if before.iter().any(|other| is_same(other, output)) {
            return Err(Failure::Usage(format!(
                "{}: two outputs would be written to it; name another file for one of them",
                shown(output)
            )));
        }
        before.push(output);
    }
    Ok(())
}

/// Whether two paths lead to the same file. Follows links. If neither file exists yet, returns
/// whether the two paths would be the same file.
fn is_same(a: &Path, b: &Path) -> bool {
    match (std::fs::metadata(a), std::fs::metadata(b)) {
        (Ok(a_is), Ok(b_is)) => is_one_file((a, &a_is), (b, &b_is)),
        (Err(_), Err(_)) => place(a).is_some_and(|a| Some(a) == place(b)),
        _ => false,
    }
}

#[cfg(unix)]
fn is_one_file((_, a): (&Path, &Metadata), (_, b): (&Path, &Metadata)) -> bool {
    use std::os::unix::fs::MetadataExt;
    // A terminal or /dev/null may be both an input and an output.
    let is_kept = a.is_file() || a.is_dir();
    is_kept && (a.dev(), a.ino()) == (b.dev(), b.ino())
}

#[cfg(not(unix))]
fn is_one_file((a, _): (&Path, &Metadata), (b, _): (&Path, &Metadata)) -> bool {
    // On this system, the stable part of `std` has no number that identifies a file, so a hard link
    // is not recognised.
    place(a).is_some_and(|a| Some(a) == place(b))
}

/// Returns the canonical folder and the file name in it.
fn place(path: &Path) -> Option<std::path::PathBuf> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    Some(folder.canonicalize().ok()?.join(path.file_name()?))
}
