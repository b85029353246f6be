//! Files of other haptic formats that the command writes from textures, and the textures that it
//! makes from such files.

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

/// A stroke that becomes faster.
const STROKE: &str = "t_s,speed_mm_s,force_n\n0,40,0.4\n0.5,60,0.5\n1.2,120,0.4\n";

/// The exported files, each with its texture and its flags. One texture states a licence, one only
/// an author, two neither; `lines.htex` has four conditions, and `bursts.htex` embeds a model.
const EXPORTS: [(&str, &str, &[&str]); 12] = [
    ("part.haptic", "part.htex", &["--to", "haptic"]),
    (
        "edited.ahap",
        "edited.htex",
        &["--to", "ahap", "--profile", "lra-175", "--seconds", "1.5", "--seed", "7"],
    ),
    ("part.json", "part.htex", &["--to", "android", "--model", "bands"]),
    ("part.kt", "part.htex", &["--to", "android", "--speed", "100"]),
    ("vinyl.hjif", "vinyl.htex", &["--to", "hjif", "--force", "0.7"]),
    (
        "wavelet.hjif",
        "vinyl.htex",
        &["--to", "hjif", "--coding", "wavelet", "--speed", "120", "--force", "0.5"],
    ),
    ("vinyl.wav", "vinyl.htex", &["--to", "wav", "--rate", "4000", "--model", "ar"]),
    ("vinyl.png", "vinyl.htex", &["--to", "png", "--speed", "100", "--force", "0.5"]),
    ("part.glb", "part.htex", &["--to", "gltf"]),
    ("vinyl.gltf", "vinyl.htex", &["--to", "gltf"]),
    ("lines.ahap", "lines.htex", &["--to", "ahap", "--stroke", "stroke.csv"]),
    ("bursts.haptic", "bursts.htex", &["--to", "haptic", "--no-embedded-plugins"]),
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

/// Exports textures, e.g. to `exported/part.kt`, and writes what the command prints with `--json`
/// next to each file, e.g. `exported/part.kt.report`. Writes a texture whose model is not built in.
pub(super) fn write_exports(
    folder: &Path,
    htex: &impl Fn(&[&str]) -> Result<()>,
    printed: &impl Fn(&[&str], &str) -> Result<()>,
) -> Result<()> {
    fs_err::write(folder.join("stroke.csv"), STROKE)?;
    fs_err::create_dir_all(folder.join("exported"))?;
    for (file, texture, flags) in EXPORTS {
        let out = format!("exported/{file}");
        let exported = [&["export", texture][..], flags, &["-o", &out, "--json"]].concat();
        printed(&exported, &format!("{out}.report"))?;
    }
    let fit = ["fit", "vinyl.csv", "--plugin", "bursts.wasm", "--model", "bursts"];
    htex(&[&fit[..], &["-o", "guest.htex"]].concat())
}
