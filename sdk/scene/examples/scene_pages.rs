//! Generates the parts of the specification that come from the code: the conformance scenes with their
//! reports, the page of findings and the schema of scenes.
//!
//! `cargo run -p htex-scene --example scene_pages`
#![allow(clippy::unwrap_used)] // It is run by hand.

#[path = "../tests/common/cases.rs"]
#[allow(dead_code)]
mod cases;

use std::path::Path;
use std::{fs, io};

use htex_format::write_file;
use htex_scene::{findings_page, scene_schema};

fn main() -> io::Result<()> {
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec");
    let folder = spec.join("scene-conformance");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    for (name, bytes) in cases::files() {
        write_file(&folder.join(name), &bytes)?;
    }
    for case in cases::cases() {
        let [scene, report] = ["scene", "report"].map(|kind| format!("{}.{kind}.json", case.name));
        write_file(&folder.join(scene), case.text.as_bytes())?;
        write_file(&folder.join(report), case.golden(&folder).as_bytes())?;
    }
    let schema = serde_json::to_string_pretty(&scene_schema())? + "\n";
    write_file(&spec.join("schemas/scene-1.json"), schema.as_bytes())?;
    write_file(&spec.join("scene-findings.md"), findings_page().as_bytes())
}
