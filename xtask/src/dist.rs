//! Installs libhtex: libraries, headers, C#, pkg-config and CMake files.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use fs_err as fs;

use crate::places::{cargo, target, workspace};
use crate::programs::run;

/// What is installed, and where.
pub struct Dist {
    /// The folder that gets `lib`, `include` and `share`.
    pub prefix: PathBuf,
    /// Without scenes and without the engine of WASM modules.
    pub small: bool,
}

/// Files of the header's folder and of the Unity package.
const HEADERS: [&str; 2] = ["htex.h", "htex.hpp"];
const UNITY: [&str; 5] = [
    "package.json",
    "Runtime/Htex.cs",
    "Runtime/Htex.asmdef",
    "Runtime/HtexNativeArray.cs",
    "Runtime/HtexSource.cs",
];

/// Libraries that a program needs beside the static library.
const SYSTEM_LIBRARIES: &str = if cfg!(target_os = "macos") {
    "-liconv -lSystem"
} else {
    "-lgcc_s -lutil -lrt -lpthread -lm -ldl -lc"
};

/// Builds and installs.
///
/// # Errors
/// A message with the file or the program.
pub fn dist(options: &Dist) -> Result<()> {
    let version = version()?;
    let built = build(options.small)?;
    let prefix = &options.prefix;
    let libraries = prefix.join("lib");
    let put = |from: &Path, to: &Path| {
        fs::create_dir_all(to.parent().unwrap_or(prefix))?;
        fs::copy(from, to)
    };
    let write = |to: PathBuf, text: String| {
        fs::create_dir_all(to.parent().unwrap_or(prefix))?;
        fs::write(to, text)
    };
    put_library(&built, &libraries, &version)?;
    put(&built.join("libhtex_c.a"), &libraries.join("libhtex.a"))?;
    let source = workspace().join("sdk/capi");
    for header in HEADERS {
        put(
            &source.join("include").join(header),
            &prefix.join("include").join(header),
        )?;
    }
    for file in UNITY {
        put(
            &source.join("unity").join(file),
            &prefix.join("share/htex/unity").join(file),
        )?;
    }
    write(libraries.join("pkgconfig/htex.pc"), pkg_config(&version))?;
    write(
        libraries.join("cmake/htex/htexConfig.cmake"),
        CMAKE.to_owned(),
    )?;
    write(
        libraries.join("cmake/htex/htexConfigVersion.cmake"),
        CMAKE_VERSION.replace("@VERSION@", &version),
    )?;
    Ok(())
}

/// Builds the libraries; returns their folder.
fn build(small: bool) -> Result<PathBuf> {
    let mut command = Command::new(cargo());
    command.args(["build", "--locked", "--package", "htex-capi"]);
    let profile = match small {
        true => {
            command.args(["--profile", "small", "--no-default-features"]);
            "small"
        }
        // With the command, whose features it then has: what both need is built once. Readers of recordings are built, too, and as
        // nothing here calls them, not linked.
        false => {
            command.args(["--release", "--package", "htex-cli"]);
            "release"
        }
    };
    run(command.current_dir(workspace()))?;
    Ok(target().join(profile))
}

/// The shared library under its full name, with links of the shorter ones.
fn put_library(built: &Path, libraries: &Path, version: &str) -> io::Result<()> {
    fs::create_dir_all(libraries)?;
    let suffix = std::env::consts::DLL_SUFFIX;
    let from = built.join(format!("{}htex_c{suffix}", std::env::consts::DLL_PREFIX));
    if !cfg!(unix) {
        return fs::copy(from, libraries.join(format!("htex{suffix}"))).map(drop);
    }
    let major = version.split('.').next().unwrap_or_default();
    let named = |version: &str| match cfg!(target_os = "macos") {
        true => format!("libhtex.{version}{suffix}"),
        false => format!("libhtex{suffix}.{version}"),
    };
    let (full, short) = (named(version), named(major));
    fs::copy(from, libraries.join(&full))?;
    link(&full, &libraries.join(&short))?;
    link(&short, &libraries.join(format!("libhtex{suffix}")))
}

/// A symbolic link in place of whatever is there.
#[cfg(unix)]
fn link(to: &str, at: &Path) -> io::Result<()> {
    match fs::remove_file(at) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    fs_err::os::unix::fs::symlink(to, at)
}

#[cfg(not(unix))]
fn link(_: &str, _: &Path) -> io::Result<()> {
    Ok(())
}

/// The version of the workspace.
fn version() -> Result<String> {
    let text = fs::read_to_string(workspace().join("Cargo.toml"))?;
    let version = text
        .lines()
        .find_map(|line| line.strip_prefix("version = "));
    let version = version.context("Cargo.toml has no version")?;
    Ok(version.trim_matches('"').to_owned())
}

fn pkg_config(version: &str) -> String {
    format!(
        "prefix=${{pcfiledir}}/../..\n\nName: htex\nDescription: Textures of touch\nVersion: {version}\n\
         Cflags: -I${{prefix}}/include\nLibs: -L${{prefix}}/lib -lhtex\nLibs.private: {SYSTEM_LIBRARIES}\n"
    )
}

const CMAKE: &str = r#"# Defines the targets htex::htex (shared) and htex::static.
get_filename_component(htex_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
if(NOT TARGET htex::htex)
    add_library(htex::htex SHARED IMPORTED)
    set_target_properties(htex::htex PROPERTIES
        IMPORTED_LOCATION "${htex_prefix}/lib/${CMAKE_SHARED_LIBRARY_PREFIX}htex${CMAKE_SHARED_LIBRARY_SUFFIX}"
        INTERFACE_INCLUDE_DIRECTORIES "${htex_prefix}/include")
    add_library(htex::static STATIC IMPORTED)
    find_package(Threads REQUIRED)
    set_target_properties(htex::static PROPERTIES
        IMPORTED_LOCATION "${htex_prefix}/lib/libhtex.a"
        INTERFACE_INCLUDE_DIRECTORIES "${htex_prefix}/include"
        INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};m")
endif()
"#;

const CMAKE_VERSION: &str = r#"set(PACKAGE_VERSION "@VERSION@")
if(PACKAGE_FIND_VERSION VERSION_GREATER PACKAGE_VERSION)
    set(PACKAGE_VERSION_COMPATIBLE FALSE)
else()
    set(PACKAGE_VERSION_COMPATIBLE TRUE)
    if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
        set(PACKAGE_VERSION_EXACT TRUE)
    endif()
endif()
"#;
