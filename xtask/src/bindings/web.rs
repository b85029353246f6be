//! Tests the npm package in Node.js, in Chromium and in bundlers.

use std::path::Path;

use anyhow::Result;

use super::{CHROMIUM, copy, fixtures, which};
use crate::places::{files, workspace};
use crate::programs::{program, run};

pub(super) fn test(folder: &Path) -> Result<()> {
    let folder = fs_err::canonicalize(folder)?;
    let (package, fixtures) = (folder.join("htex"), folder.join("fixtures"));
    crate::web::web(&package)?;
    fixtures::write(&fixtures)?;
    catalogue(&fixtures, &package)?;
    let tests = folder.join("tests");
    fs_err::create_dir_all(&tests)?;
    for file in files(&workspace().join("sdk/bindings/web/tests"))? {
        copy(&file, &tests.join(file.file_name().unwrap_or_default()))?;
    }
    let quiet = ["--silent", "--no-audit", "--no-fund"];
    run(program("npm", &tests).arg("install").args(quiet))?;
    run(program("npm", &tests).arg("install").args(quiet).args(["--no-save"]).arg(&package))?;
    for project in ["tsconfig.json", "tsconfig.node.json"] {
        run(program("npx", &tests).args(["tsc", "--project", project]))?;
    }
    let chromium = CHROMIUM.find().unwrap_or("chromium");
    let example = workspace().join("examples/web");
    run(program("node", &tests)
        .args([
            "--test",
            "--test-concurrency=1",
            "node.test.mjs",
            "library.test.mjs",
            "loading.test.mjs",
            "pad.test.mjs",
            "pointer.test.mjs",
            "sound.test.mjs",
            "author.test.mjs",
            "import.test.mjs",
            "export.test.mjs",
            "scene.test.mjs",
            "scene-browser.test.mjs",
            "author-browser.test.mjs",
            "browser.test.mjs",
            "mesh.test.mjs",
            "bundles.test.mjs",
        ])
        .env("HTEX_PACKAGE", &package)
        .env("HTEX_FIXTURES", &fixtures)
        .env("HTEX_EXAMPLE", fs_err::canonicalize(example)?)
        .env("HTEX_CHROMIUM", which(chromium)))?;
    conformance(&package)
}

/// Tests the package as a reader and player on some of the conformance files. Testing all of them
/// would take minutes, because Node.js starts once for each file.
fn conformance(package: &Path) -> Result<()> {
    let script = workspace().join("sdk/bindings/web/tests/conformance.mjs");
    let (script, package) = (script.display(), package.display());
    let reader = format!("node '{script}' '{package}' {{part}} {{file}}");
    run(program(&fixtures::command()?, &workspace())
        .args(["conformance", "run", "--files", "spec", "--command", &reader, "--jobs", "2"])
        .args(["--part", "recordings,playing"]))
}

/// Builds a library whose catalogue plays textures with the package.
fn catalogue(fixtures: &Path, package: &Path) -> Result<()> {
    let recipe = "[library]\nname = \"surfaces\"\n[[textures]]\nrecordings = \"vinyl.csv\"\nmodels = [\"bands\"]\n\
                  license = \"CC0-1.0\"\nat = { speed_mm_s = 80, force_n = 0.5 }\n";
    let file = fixtures.join("library.toml");
    fs_err::write(&file, recipe)?;
    run(program(&fixtures::command()?, fixtures)
        .args(["build", "library.toml", "-o", "catalogue", "--browser-package"])
        .arg(package)
        .stdout(std::process::Stdio::null()))
}
