//! Writes the generated files of the specification: the conformance files with their reports, the
//! page of findings, and the schemas of manifests and reports.
//!
//! `cargo run -p htex-format --example conformance`

#[path = "../tests/common/mod.rs"]
mod common;

use std::path::Path;
use std::{fs, io};

use htex_format::{manifest_schema, report_schema, validation_page, write_file};

fn main() -> io::Result<()> {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec");
    let files = spec.join("conformance");
    if files.exists() {
        fs::remove_dir_all(&files)?;
    }
    fs::create_dir_all(&files)?;
    fs::create_dir_all(spec.join("schemas"))?;
    for case in common::cases::cases() {
        write_file(&files.join(format!("{}.htex", case.name)), &case.bytes)?;
        write_file(
            &files.join(format!("{}.report.json", case.name)),
            case.golden().as_bytes(),
        )?;
    }
    for (file, schema) in [
        ("manifest-1.json", manifest_schema()),
        ("report-1.json", report_schema()),
    ] {
        let schema = serde_json::to_string_pretty(&schema)? + "\n";
        write_file(&spec.join("schemas").join(file), schema.as_bytes())?;
    }
    write_file(&spec.join("validation.md"), validation_page().as_bytes())
}
