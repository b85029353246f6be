//! Lays out the C player for microcontroller builds.

use std::path::Path;

use anyhow::Result;
use fs_err as fs;

use crate::places::{version, workspace};

/// Placeholder that the workspace's version replaces.
const VERSION: &str = "@version@";

/// The folder and the name of a file in the workspace.
type Own = (&'static str, &'static str);
/// A folder to write, and its files: where each file is in the workspace, and its path in the new
/// folder.
type Layout = (&'static str, &'static [(Own, &'static str)]);

const SOURCE: Own = ("sdk/runtime/player/c", "htex_player.c");
const HEADER: Own = ("sdk/runtime/player/c", "htex_player.h");

const LAYOUTS: [Layout; 3] = [
    (
        "arduino/HtexPlayer",
        &[
            (("sdk/runtime/player/c/arduino", "library.properties"), "library.properties"),
            (SOURCE, "src/htex_player.c"),
            (HEADER, "src/htex_player.h"),
            (
                ("sdk/runtime/player/c/arduino/examples/Texture", "Texture.ino"),
                "examples/Texture/Texture.ino",
            ),
            (("sdk/runtime/player/c/examples", "cloth.h"), "examples/Texture/cloth.h"),
        ],
    ),
    (
        "esp-idf/htex_player",
        &[
            (("sdk/runtime/player/c/esp-idf", "CMakeLists.txt"), "CMakeLists.txt"),
            (("sdk/runtime/player/c/esp-idf", "idf_component.yml"), "idf_component.yml"),
            (SOURCE, "htex_player.c"),
            (HEADER, "include/htex_player.h"),
        ],
    ),
    (
        "zephyr/htex_player",
        &[
            (("sdk/runtime/player/c/zephyr", "module.yml"), "zephyr/module.yml"),
            (("sdk/runtime/player/c/zephyr", "CMakeLists.txt"), "zephyr/CMakeLists.txt"),
            (("sdk/runtime/player/c/zephyr", "Kconfig"), "zephyr/Kconfig"),
            (SOURCE, "src/htex_player.c"),
            (HEADER, "include/htex_player.h"),
        ],
    ),
];

const LICENCES: [&str; 2] = ["LICENSE-APACHE", "LICENSE-MIT"];

/// Writes an Arduino library, an ESP-IDF component and a Zephyr module to a folder.
///
/// # Errors
/// When a file cannot be read or written.
pub fn firmware(out: &Path) -> Result<()> {
    let version = version()?;
    for (layout, files) in LAYOUTS {
        let licences = LICENCES.map(|name| (("", name), name));
        for ((folder, name), to) in files.iter().copied().chain(licences) {
            let text = fs::read_to_string(workspace().join(folder).join(name))?;
            let to = out.join(layout).join(to);
            fs::create_dir_all(to.parent().unwrap_or(out))?;
            fs::write(to, text.replace(VERSION, &version))?;
        }
    }
    Ok(())
}
