//! The files that tell a desktop the types of files of htex.

use std::path::{Path, PathBuf};
use std::process::Command;

use htex_tests::workspace;

fn files() -> PathBuf {
    workspace().join("xtask/src/release/desktop")
}

/// Returns the conformance files of a folder with this beginning and this extension.
fn some(folder: &str, extension: &str) -> Vec<PathBuf> {
    let folder = workspace().join("spec").join(folder);
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_one = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        name.starts_with("valid") && path.extension().is_some_and(|e| e == extension)
    };
    let mut all: Vec<PathBuf> = entries.filter(is_one).collect();
    all.sort();
    all
}

/// `file` names every valid asset and library, and does not take another archive for one.
#[test]
fn file_knows_assets_and_libraries() {
    let told = |path: &Path| {
        let mut file = Command::new("file");
        file.args(["--brief", "--mime-type", "-m"]).arg(files().join("htex.magic")).arg(path);
        let output = file.output().ok().filter(|output| output.status.success())?;
        Some(String::from_utf8(output.stdout).unwrap().trim().to_owned())
    };
    let assets = some("conformance", "htex");
    assert!(!assets.is_empty());
    if !xtask::needs::FILE.met(told(&assets[0]).is_some()) {
        return;
    }
    for asset in assets {
        assert_eq!(told(&asset).unwrap(), "application/vnd.htex+zip", "{asset:?}");
    }
    let libraries = some("library-conformance", "htexlib");
    assert!(!libraries.is_empty());
    for library in libraries {
        assert_eq!(told(&library).unwrap(), "application/vnd.htexlib", "{library:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("other.zip");
    std::fs::write(&other, b"PK\x03\x04mimetypeapplication/epub+zip, and more bytes").unwrap();
    assert!(!told(&other).unwrap().contains("htex"));
}

/// The shared MIME database takes the types, and the desktop entry opens the type of assets.
#[test]
fn the_mime_database_takes_the_types() {
    let entry = std::fs::read_to_string(files().join("org.htex.htex.desktop")).unwrap();
    assert!(entry.contains("MimeType=application/vnd.htex+zip;"));
    let folder = tempfile::tempdir().unwrap();
    let packages = folder.path().join("packages");
    std::fs::create_dir(&packages).unwrap();
    std::fs::copy(files().join("htex.xml"), packages.join("htex.xml")).unwrap();
    let updated = Command::new("update-mime-database").arg(folder.path()).output();
    if !xtask::needs::MIME.met(updated.is_ok_and(|output| output.status.success())) {
        return;
    }
    let globs = std::fs::read_to_string(folder.path().join("globs2")).unwrap();
    for line in [
        "50:application/vnd.htex+zip:*.htex",
        "50:application/vnd.htexlib:*.htexlib",
        "60:application/vnd.htex.scene+json:*.scene.json",
    ] {
        assert!(globs.lines().any(|other| other == line), "{line} is not in {globs}");
    }
}
