//! Builds the npm package of `sdk/web`.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::places::{cargo, target, workspace};

const TARGET: &str = "wasm32-unknown-unknown";

/// Files that are copied as they are.
const COPIED: [&str; 12] = [
    "core.js",
    "guarded.js",
    "guests.js",
    "htexlib.js",
    "index.d.ts",
    "index.js",
    "library.js",
    "node.js",
    "pointer.js",
    "stage.js",
    "texture.js",
    "worker.js",
];

/// What the file of the audio worklet is made of. It has no imports: bundlers copy the file of a worklet alone.
const PROCESSOR: [&str; 5] = [
    "guests.js",
    "core.js",
    "texture.js",
    "stage.js",
    "processor.js",
];

/// Builds the package into a folder.
///
/// # Errors
/// A message with the file or the program.
pub fn web(out: &Path) -> Result<(), String> {
    let source = workspace().join("sdk/web");
    let library = library()?;
    let wrong = |path: PathBuf| move |error: io::Error| format!("{}: {error}", path.display());
    fs::create_dir_all(out).map_err(wrong(out.to_owned()))?;
    let copy = |from: PathBuf, name: &str| {
        fs::copy(&from, out.join(name))
            .map(drop)
            .map_err(wrong(from))
    };
    for name in COPIED {
        copy(source.join("src").join(name), name)?;
    }
    for name in ["package.json", "README.md"] {
        copy(source.join(name), name)?;
    }
    copy(library, "htex.wasm")?;
    let mut processor = String::new();
    for name in PROCESSOR {
        let path = source.join("src").join(name);
        let text = fs::read_to_string(&path).map_err(wrong(path))?;
        processor += &without_modules(&text);
    }
    let path = out.join("processor.js");
    fs::write(&path, processor).map_err(wrong(path))
}

/// Builds the library for WASM; returns its file.
fn library() -> Result<PathBuf, String> {
    let status = Command::new(cargo())
        .args(["build", "--locked", "--package", "htex-capi", "--lib"])
        .args(["--profile", "small", "--no-default-features"])
        .args(["--features", "library"])
        .args(["--target", TARGET])
        .env(
            "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS",
            "-Ctarget-feature=+simd128",
        )
        .current_dir(workspace())
        .status()
        .map_err(|error| format!("cargo: {error}"))?;
    if !status.success() {
        return Err(format!(
            "the library for WASM cannot be built; `rustup target add {TARGET}` brings its target"
        ));
    }
    Ok(target().join(TARGET).join("small/htex_c.wasm"))
}

/// A file's text without its imports and with its exports as plain declarations.
fn without_modules(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with("import "));
    lines
        .map(|line| line.strip_prefix("export ").unwrap_or(line))
        .flat_map(|line| [line, "\n"])
        .collect()
}
