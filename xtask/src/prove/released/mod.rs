//! Tests a release without an installed Rust: in an empty Debian root, and under Wine.

mod bare;
mod wine;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use fs_err as fs;

use crate::places::workspace;
use crate::programs::{program, run};

pub(super) use bare::Bare;
pub(super) use bare::{bare, bare_root};
pub(super) use wine::wine;

#[derive(Debug, Args)]
pub struct Folder {
    /// The folder to which `cargo xtask release --out DIR` wrote
    #[arg(long, value_name = "DIR")]
    release: PathBuf,
}

impl Folder {
    fn released(&self) -> Result<PathBuf> {
        Ok(fs::canonicalize(&self.release)?)
    }
}

/// Returns the file in a folder whose name has this ending, and the name without the ending.
fn archive(folder: &Path, ending: &str) -> Result<(PathBuf, String)> {
    for file in crate::places::files(folder)? {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        if let Some(stem) = name.strip_suffix(ending).map(str::to_owned) {
            return Ok((file, stem));
        }
    }
    bail!(
        "{}: no file ends with {ending}; `cargo xtask release --out` writes them",
        folder.display()
    )
}

/// A C compiler, and CMake's names for its system and processor.
struct Compiler {
    gcc: &'static str,
    /// Debian's package.
    package: &'static str,
    system: &'static str,
    processor: &'static str,
    /// The libraries that CMake should find.
    libraries: &'static str,
}

const CMAKE: &str = "\
cmake_minimum_required(VERSION 3.16)
project(play C)
find_package(htex REQUIRED)
foreach(library LIBRARIES)
    add_executable(play_${library} play.c)
    target_link_libraries(play_${library} PRIVATE htex::${library} m)
endforeach()
";

impl Compiler {
    /// Builds the C player with the libraries of the unpacked archive, once with pkg-config and
    /// once with CMake.
    fn players(&self, prefix: &Path, work: &Path) -> Result<()> {
        let source = workspace().join("sdk/bindings/capi/examples/play.c");
        let build = work.join("built");
        fs::create_dir_all(&build)?;
        fs::copy(source, build.join("play.c"))?;
        let cmake = CMAKE.replace("LIBRARIES", self.libraries);
        fs::write(build.join("CMakeLists.txt"), cmake)?;
        let line = format!(
            "{} -std=c11 -Wall -Werror play.c $(pkg-config --cflags --libs htex) -lm -o ../play_pkg_config",
            self.gcc
        );
        let mut compile = program("sh", &build);
        compile.args(["-c", &line]);
        compile.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"));
        run(&mut compile).with_context(|| format!("the package {}", self.package))?;
        let mut configure = program("cmake", &build);
        configure.args([
            "-S",
            ".",
            "-B",
            ".",
            // The players run in the root, where paths of this machine do not exist.
            "-DCMAKE_SKIP_RPATH=ON",
            "-DCMAKE_RUNTIME_OUTPUT_DIRECTORY=..",
        ]);
        configure.arg(format!("-DCMAKE_C_COMPILER={}", self.gcc));
        configure.arg(format!("-DCMAKE_SYSTEM_NAME={}", self.system));
        configure.arg(format!("-DCMAKE_SYSTEM_PROCESSOR={}", self.processor));
        run(configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display())))?;
        run(program("cmake", &build).args(["--build", "."]))
    }
}
