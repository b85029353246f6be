//! Builds the npm package from `sdk/bindings/web`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result};
use fs_err as fs;

use crate::places::{cargo, target, workspace};
use crate::platform::without_places;
use crate::programs::run;

const TARGET: &str = "wasm32-unknown-unknown";

/// Files that are copied unchanged.
const COPIED: [&str; 34] = [
    "author-core.js",
    "author-serve.js",
    "author-thread.js",
    "author-worker.node.js",
    "author.d.ts",
    "author.js",
    "core.js",
    "files.js",
    "guarded.js",
    "guests.js",
    "host.js",
    "htexlib.js",
    "import.d.ts",
    "import.js",
    "import.node.js",
    "index.d.ts",
    "index.js",
    "index.node.js",
    "library.js",
    "loop.js",
    "manifest.d.ts",
    "measured.js",
    "node.js",
    "options.js",
    "pad.js",
    "pointer.js",
    "scene.d.ts",
    "scene.js",
    "scene.node.js",
    "serve.js",
    "stage.js",
    "texture.js",
    "web.d.ts",
    "worker.node.js",
];

/// The files that become the file of the audio worklet. That file must not import others, because
/// bundlers copy only the worklet's file itself.
const PROCESSOR: [&str; 9] = [
    "guests.js",
    "core.js",
    "options.js",
    "measured.js",
    "texture.js",
    "stage.js",
    "sources.js",
    "track.js",
    "processor.js",
];

/// The files that become the file of the page's worker. Bundlers also copy only that file.
const WORKER: [&str; 8] = [
    "guests.js",
    "core.js",
    "options.js",
    "measured.js",
    "texture.js",
    "stage.js",
    "serve.js",
    "worker.js",
];

/// The files that become the file of the worker that fits models.
const AUTHOR_WORKER: [&str; 5] =
    ["guests.js", "core.js", "author-core.js", "author-serve.js", "author-worker.js"];

/// The player's module.
const PLAYER: &str = "htex.wasm";

/// The features of `sdk/bindings/web/author`, and the name of the module built with each.
const MODULES: [(&str, &str); 3] =
    [("make", "htex-author.wasm"), ("import", "htex-import.wasm"), ("scene", "htex-scene.wasm")];

/// Builds the package into a folder.
///
/// # Errors
/// A message with the file or the program.
pub fn web(out: &Path) -> Result<()> {
    let source = workspace().join("sdk/bindings/web");
    let modules = modules()?;
    fs::create_dir_all(out)?;
    for (_, name) in MODULES {
        fs::copy(modules.join(name), out.join(name))?;
    }
    let copy = |from: PathBuf, name: &str| fs::copy(from, out.join(name));
    for name in COPIED {
        copy(source.join("src").join(name), name)?;
    }
    for name in ["package.json", "README.md"] {
        copy(source.join(name), name)?;
    }
    for name in ["LICENSE-MIT", "LICENSE-APACHE"] {
        copy(workspace().join(name), name)?;
    }
    copy(modules.join(PLAYER), PLAYER)?;
    join(&source.join("src"), &PROCESSOR, &out.join("processor.js"))?;
    join(&source.join("src"), &WORKER, &out.join("worker.js"))?;
    join(&source.join("src"), &AUTHOR_WORKER, &out.join("author-worker.js"))
}

/// Builds the modules, and returns their folder. All modules of a package are built to the same
/// file, so each module replaces the one before it, and a second build would compile all of them
/// again. Therefore, each process builds them only once.
fn modules() -> Result<PathBuf> {
    static BUILT: Mutex<bool> = Mutex::new(false);
    let mut is_built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = target().join("web-modules");
    if !*is_built {
        fs::create_dir_all(&folder)?;
        let player = module("htex-capi", "small", &["--features", "library"])?;
        fs::copy(player.join("htex_c.wasm"), folder.join(PLAYER))?;
        for (feature, name) in MODULES {
            let built = module("htex-web-author", "author", &["--features", feature])?;
            fs::copy(built.join("htex_author_c.wasm"), folder.join(name))?;
        }
        *is_built = true;
    }
    Ok(folder)
}

/// Joins files of a folder into one script.
fn join(folder: &Path, names: &[&str], out: &Path) -> Result<()> {
    let mut script = String::new();
    for name in names {
        script += &without_modules(&fs::read_to_string(folder.join(name))?);
    }
    Ok(fs::write(out, script)?)
}

/// Builds a package for WASM with a profile, and returns the folder of its file.
fn module(package: &str, profile: &str, features: &[&str]) -> Result<PathBuf> {
    let mut build = Command::new(cargo());
    build
        .args(["build", "--locked", "--package", package, "--lib"])
        .args(["--profile", profile, "--no-default-features"])
        .args(features)
        .args(["--target", TARGET])
        .env(
            "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS",
            format!("-Ctarget-feature=+simd128 {}", without_places()),
        )
        .current_dir(workspace());
    run(&mut build).context("`rustup target add` brings the target")?;
    Ok(target().join(TARGET).join(profile))
}

/// Returns a file's text without its imports and with its exports as plain declarations.
fn without_modules(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with("import "));
    lines
        .map(|line| line.strip_prefix("export ").unwrap_or(line))
        .flat_map(|line| [line, "\n"])
        .collect()
}
