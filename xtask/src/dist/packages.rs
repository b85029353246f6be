//! Writes the files through which pkg-config and CMake find the libraries.

use std::path::Path;

use anyhow::Result;
use fs_err as fs;

use crate::platform::System;

/// Writes the files for pkg-config and for CMake into `lib`.
pub(super) fn write(lib: &Path, version: &str, system: System, whole: bool) -> Result<()> {
    let (pkg_config, cmake) = (lib.join("pkgconfig"), lib.join("cmake/htex"));
    fs::create_dir_all(&pkg_config)?;
    fs::create_dir_all(&cmake)?;
    let mut targets = cmake_targets("htex", "static", "", system);
    fs::write(pkg_config.join("htex.pc"), htex_pc("htex", "", version))?;
    if whole {
        let text = htex_pc("htex-whole", "/whole", version);
        fs::write(pkg_config.join("htex-whole.pc"), text)?;
        targets += &cmake_targets("whole", "whole_static", "/whole", system);
    }
    fs::write(cmake.join("htexConfig.cmake"), CMAKE.replace("@TARGETS@", &targets))?;
    let text = CMAKE_VERSION.replace("@VERSION@", version);
    fs::write(
        cmake.join("htexConfigVersion.cmake"),
        text.replace("@LINE@", &line(version).replace('.', "[.]")),
    )?;
    Ok(())
}

/// Returns the part of a version that all compatible versions share: 0.2 for 0.2.1, and 1 for
/// 1.2.3.
fn line(version: &str) -> String {
    let parts: Vec<&str> = version.split('.').collect();
    let length = if parts[0] == "0" { 2 } else { 1 };
    parts[..length.min(parts.len())].join(".")
}

fn htex_pc(name: &str, folder: &str, version: &str) -> String {
    format!(
        "prefix=${{pcfiledir}}/../..\n\nName: {name}\nDescription: Textures of touch\nVersion: {version}\n\
         Cflags: -I${{prefix}}/include\nLibs: -L${{prefix}}/lib{folder} -lhtex\nLibs.private: -lpthread -ldl -lm\n"
    )
}

/// Returns the CMake target of the shared library and, if there is one, the target of the static
/// library.
fn cmake_targets(shared: &str, fixed: &str, folder: &str, system: System) -> String {
    let location = match system {
        System::Linux => "IMPORTED_LOCATION \"${htex_prefix}/lib@/libhtex.so\"",
        System::MacOs => "IMPORTED_LOCATION \"${htex_prefix}/lib@/libhtex.dylib\"",
        System::Windows => {
            "IMPORTED_LOCATION \"${htex_prefix}/lib@/htex.dll\"\n        IMPORTED_IMPLIB \"${htex_prefix}/lib@/htex.lib\""
        }
    };
    let mut text = format!(
        "    add_library(htex::{shared} SHARED IMPORTED)\n    set_target_properties(htex::{shared} PROPERTIES\n        \
         {location}\n        INTERFACE_INCLUDE_DIRECTORIES \"${{htex_prefix}}/include\")\n"
    );
    if system == System::Linux {
        text += &format!(
            "    add_library(htex::{fixed} STATIC IMPORTED)\n    set_target_properties(htex::{fixed} PROPERTIES\n        \
             IMPORTED_LOCATION \"${{htex_prefix}}/lib@/libhtex.a\"\n        \
             INTERFACE_INCLUDE_DIRECTORIES \"${{htex_prefix}}/include\"\n        \
             INTERFACE_LINK_LIBRARIES \"Threads::Threads;${{CMAKE_DL_LIBS}};m\")\n"
        );
    }
    text.replace('@', folder)
}

const CMAKE: &str = r#"# Defines htex::htex (shared) and, where there is one, htex::static; htex::whole and htex::whole_static have scenes, libraries of
# textures and the engine of WASM modules.
get_filename_component(htex_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
if(NOT TARGET htex::htex)
    find_package(Threads REQUIRED)
@TARGETS@endif()
"#;

const CMAKE_VERSION: &str = r#"set(PACKAGE_VERSION "@VERSION@")
set(PACKAGE_VERSION_COMPATIBLE FALSE)
# Programs of this line of versions, of no later one.
if("${PACKAGE_FIND_VERSION}." MATCHES "^@LINE@[.]" AND NOT PACKAGE_FIND_VERSION VERSION_GREATER PACKAGE_VERSION)
    set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif()
if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
    set(PACKAGE_VERSION_EXACT TRUE)
endif()
"#;

#[cfg(test)]
mod tests {
    use super::line;

    #[test]
    fn versions_have_a_line() {
        assert_eq!(line("0.2.1"), "0.2");
        assert_eq!(line("1.2.3"), "1");
    }
}
