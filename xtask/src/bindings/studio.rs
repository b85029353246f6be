//! Tests the studio in Chromium and in Firefox.

use std::path::Path;

use anyhow::Result;

use super::{CHROMIUM, copy, exchanged, fixtures, which};
use crate::places::{files, workspace};
use crate::programs::{program, run};
use crate::prove::WHOLE;

pub(super) fn test(folder: &Path) -> Result<()> {
    tests(folder, &[])
}

/// Tests it in every window. [`test`] takes a sample.
pub(super) fn all(folder: &Path) -> Result<()> {
    tests(folder, &[(WHOLE, "1")])
}

fn tests(folder: &Path, variables: &[(&str, &str)]) -> Result<()> {
    let folder = fs_err::canonicalize(folder)?;
    let page = folder.join("page");
    crate::studio::studio(&page)?;
    let tests = folder.join("tests");
    fs_err::create_dir_all(&tests)?;
    for file in files(&workspace().join("sdk/bindings/studio/tests"))? {
        copy(&file, &tests.join(file.file_name().unwrap_or_default()))?;
    }
    exchanged::copy_model_file(&tests)?;
    crate::studio::install(&tests)?;
    let chromium = CHROMIUM.find().unwrap_or("chromium");
    run(program("node", &tests)
        .args(["--test", "--test-concurrency=1"])
        .args(["page.test.mjs", "import.test.mjs", "exports.test.mjs", "opening.test.mjs"])
        .args(["history.test.mjs", "trust.test.mjs", "knobs.test.mjs", "windows.test.mjs"])
        .args(["slots.test.mjs", "look.test.mjs", "served.test.mjs", "firefox.test.mjs"])
        .envs(variables.iter().copied())
        .env("HTEX_STUDIO", &page)
        .env("HTEX_COMMAND", fixtures::command()?)
        .env("HTEX_CHROMIUM", which(chromium)))
}
