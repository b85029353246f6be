//! Files of other haptic formats that the command writes from a texture, and the textures that it
//! makes from these files.

use std::path::Path;

use anyhow::Result;

use super::copy;
use crate::places::workspace;

/// A model file of the Penn Haptic Texture Toolkit. It is stored in the repository, because nothing
/// can write this format.
const HATT: &str = "sdk/make/exchange/tests/felt.xml";
/// Settings that no file of a signal states.
const GIVEN: [&str; 6] = ["--full-scale", "0.2", "--speed", "80", "--force", "0.4"];

/// The imported files, each with its settings.
const IMPORTS: [(&str, &[&str]); 6] = [
    ("felt.xml", &["--license", "CC-BY-4.0"]),
    ("vinyl.glb", &[]),
    ("shake.haptic", &["--quantity", "acceleration"]),
    (
        "taps.ahap",
        &[
            "--model",
            "ar,bands",
            "--option",
            "ar.order=8",
            "--profile",
            "quest",
            "--level",
            "fitted",
            "--keep-reference",
            "--license",
            "CC0-1.0",
            "--tag",
            "smooth",
        ],
    ),
    ("strip.hjif", &["--model", "bands"]),
    ("row.png", &["--pitch", "0.5"]),
];

/// Copies the model file.
pub(super) fn copy_model_file(folder: &Path) -> Result<()> {
    copy(&workspace().join(HATT), &folder.join("felt.xml"))
}

/// Writes files from `vinyl.htex`, and the texture that the command makes from each file, e.g.
/// `imported/taps.htex` from `taps.ahap`.
pub(super) fn write(folder: &Path, htex: &impl Fn(&[&str]) -> Result<()>) -> Result<()> {
    copy_model_file(folder)?;
    let formats = [
        ("haptic", "shake.haptic"),
        ("ahap", "taps.ahap"),
        ("hjif", "strip.hjif"),
        ("png", "row.png"),
    ];
    for (format, file) in formats {
        let exported = ["export", "vinyl.htex", "--model", "bands", "--to", format];
        htex(&[&exported[..], &["-o", file]].concat())?;
    }
    fs_err::create_dir_all(folder.join("imported"))?;
    for (file, settings) in IMPORTS {
        let (stem, extension) = file.split_once('.').unwrap_or((file, ""));
        let is_signal = !matches!(extension, "xml" | "glb");
        let given = if is_signal { &GIVEN[..] } else { &[] };
        let out = format!("imported/{stem}.htex");
        htex(&[&["import", file][..], given, settings, &["-o", &out]].concat())?;
    }
    Ok(())
}
