//! Writes the generated files of the specification: the conformance recordings with their reports, and
//! the page of findings.
//!
//! `cargo run -p htex-author --example recording_pages`
#![allow(clippy::unwrap_used)] // It is run by hand.

#[path = "../tests/common/recordings.rs"]
#[allow(dead_code)]
mod recordings;

use std::path::Path;
use std::{fs, io};

use htex_author::findings::findings_page;
use htex_format::write_file;

fn main() -> io::Result<()> {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec");
    let folder = spec.join("recording-conformance");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    for case in recordings::cases() {
        write_file(&folder.join(case.file()), case.text.as_bytes())?;
        write_file(&folder.join(case.report()), case.golden(&folder).as_bytes())?;
    }
    write_file(
        &spec.join("recording-findings.md"),
        findings_page().as_bytes(),
    )
}
