//! Generated files. Tests compare these files with what the code generates. If `HTEX_GENERATE=1` is
//! set, the tests write the files instead; `cargo xtask generate` runs them in this way. The names
//! of these tests start with `generated_`.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;
use std::process::Command;

use anyhow::Result;
use fs_err as fs;

/// If this variable is 1, the tests write the files that they would otherwise compare.
const VARIABLE: &str = "HTEX_GENERATE";

/// The test programs that have generated files.
const PROGRAMS: [&str; 2] = ["command", "it"];

/// Writes all generated files, in the same build as `cargo test`.
///
/// # Errors
/// When a test of a generated file fails.
pub fn generate() -> Result<()> {
    let mut cargo = Command::new(crate::places::cargo());
    cargo.args(["test", "--quiet"]);
    cargo.args(PROGRAMS.iter().flat_map(|test| ["--test", test]));
    // One test at a time, because several write parts of the same document.
    cargo.args(["--", "generated_", "--test-threads=1"]);
    cargo.env(VARIABLE, "1");
    crate::programs::run(cargo.current_dir(crate::places::workspace()))
}

/// A generated file: its path relative to the workspace, and its bytes.
pub type File = (String, Vec<u8>);

/// Compares a generated file with these bytes, or writes it.
///
/// # Panics
/// When the file is stale or cannot be written.
pub fn file(path: impl AsRef<str>, bytes: &[u8]) {
    file_with(path, bytes, |kept| kept == bytes);
}

/// As [`file()`], but `is_fresh` decides whether the existing bytes are up to date.
///
/// # Panics
/// As [`file()`].
#[allow(clippy::panic)] // It fails a test.
pub fn file_with(path: impl AsRef<str>, bytes: &[u8], is_fresh: impl FnOnce(&[u8]) -> bool) {
    let name = path.as_ref();
    let path = crate::places::workspace().join(name);
    if is_written() {
        return write(&path, bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    let is_fresh = fs::read(path).is_ok_and(|kept| is_fresh(&kept));
    assert!(is_fresh, "{name} is stale: run `cargo xtask generate`");
}

/// Compares the part of a document between the lines `<!-- NAME, generated -->` and `<!-- end -->`
/// with this text, or writes that part.
///
/// # Panics
/// As [`file()`], and when the document has no such part.
pub fn section(path: &str, name: &str, text: &str) {
    section_with(path, name, text, |kept| kept == text);
}

/// As [`section`], but `is_fresh` decides whether the existing text is up to date.
///
/// # Panics
/// As [`section`].
#[allow(clippy::panic)] // It fails a test.
pub fn section_with(path: &str, name: &str, text: &str, is_fresh: impl FnOnce(&str) -> bool) {
    let document = fs::read_to_string(crate::places::workspace().join(path)).unwrap_or_default();
    let begin = format!("<!-- {name}, generated -->\n");
    let parts = document
        .split_once(&begin)
        .and_then(|(before, rest)| Some((before, rest.split_once("<!-- end -->")?)));
    let Some((before, (kept, after))) = parts else {
        panic!("{path}: there is no part {begin}");
    };
    let bytes = format!("{before}{begin}{text}<!-- end -->{after}");
    file_with(path, bytes.as_bytes(), |_| is_fresh(kept));
}

/// Compares the files of a folder, which must contain nothing else; or writes the files and removes
/// all others.
///
/// # Panics
/// As [`file()`], and when the folder has other files or cannot be read.
pub fn folder(path: &str, files: &[File]) {
    for (path, bytes) in files {
        file(path, bytes);
    }
    only(path, files.iter().map(|(path, _)| path.as_str()));
}

/// Fails if a folder has files other than `expected` (paths relative to the workspace). If
/// generated files are written, removes the other files instead.
///
/// # Panics
/// When the folder has other files, or cannot be read.
#[allow(clippy::panic)] // It fails a test.
pub fn only<'a>(path: &str, expected: impl IntoIterator<Item = &'a str>) {
    let expected: BTreeSet<&str> = expected.into_iter().collect();
    let failed = |error: io::Error| -> ! { panic!("{path}: {error}") };
    let entries = fs::read_dir(crate::places::workspace().join(path));
    for entry in entries.unwrap_or_else(|error| failed(error)) {
        let entry = entry.unwrap_or_else(|error| failed(error));
        let name = format!("{path}/{}", entry.file_name().to_string_lossy());
        if expected.contains(name.as_str()) {
            continue;
        }
        assert!(is_written(), "{name} is not generated any more: run `cargo xtask generate`");
        fs::remove_file(entry.path()).unwrap_or_else(|error| failed(error));
    }
}

/// Whether generated files are written instead of compared.
pub fn is_written() -> bool {
    std::env::var_os(VARIABLE).is_some_and(|value| value == "1")
}

fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(path, bytes)
}
