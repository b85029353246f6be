//! Links the libraries so that they export only the names in the header.
//!
//! Cargo's static library exports the names of Rust's standard library and of all dependencies. Two
//! such libraries cannot be linked in one program ("multiple definition of rust_eh_personality").
//! Therefore this module links the library's objects into one object, drops everything that no
//! function of the header needs, and makes all other names local. It links the shared library from
//! the same objects, and gives its names a version.

use std::path::Path;

use anyhow::{Context, Result};
use fs_err as fs;

use super::copy;
use crate::places::workspace;
use crate::platform::{Build, System};
use crate::programs::run;

/// The version of the interface, `HTEX_API_VERSION`. The first text is the major number, which is
/// the version of the shared library. The second text has both numbers and is the version of the
/// library's names.
const API: (&str, &str) = ("1", "1.0");

/// Puts the libraries from a build folder into `lib`. With `is_merged`, the static library has a
/// single section of each kind. This halves the size of a library with a hundred thousand
/// functions, but a program then links either the whole library or nothing.
pub(super) fn put(build: &Build, built: &Path, lib: &Path, is_merged: bool) -> Result<()> {
    fs::create_dir_all(lib)?;
    match build.platform().system {
        System::Linux => {
            put_static(build, built, lib, is_merged)?;
            put_shared(build, built, lib)
        }
        System::MacOs => put_dylib(built, lib),
        System::Windows => put_dll(build, built, lib),
    }
}

/// Makes the static library from a single object.
fn put_static(build: &Build, built: &Path, lib: &Path, is_merged: bool) -> Result<()> {
    let object = built.join("htex.o");
    let mut link = build.utility("ld");
    // Section groups are dissolved, because a linker keeps only one group of each name. References
    // to another library's group of this name would then refer to a name that is local here.
    link.args(["-r", "--gc-sections", "--force-group-allocation"]);
    // The functions for Windows paths exist only on Windows.
    for name in functions()?.iter().filter(|name| !name.ends_with("_wide")) {
        // Marks the name as used. Otherwise everything would be dropped.
        link.args(["-u", name]);
    }
    link.arg("--whole-archive").arg(built.join("libhtex_c.a"));
    run(link.arg("-o").arg(&object))?;
    if is_merged {
        let script = built.join("htex.ld");
        fs::write(&script, SECTIONS)?;
        let merged = built.join("htex-merged.o");
        let mut link = build.utility("ld");
        run(link.args(["-r", "-T"]).arg(script).arg(&object).arg("-o").arg(&merged))?;
        fs::rename(merged, &object)?;
    }
    // Also removes the bitcode that a compiler embeds for link-time optimisation, if the linker has
    // not dropped it already.
    let mut localise = build.utility("objcopy");
    localise.args(["--wildcard", "--keep-global-symbol=htex_*"]);
    localise.args(["--strip-debug", "-R", ".llvmbc", "-R", ".llvmcmd"]);
    run(localise.args(["-R", ".comment"]).arg(&object))?;
    // Run after the names were made local, because `--strip-unneeded` keeps global names.
    run(build.utility("objcopy").arg("--strip-unneeded").arg(&object))?;
    let archive = lib.join("libhtex.a");
    // `ar` would add to an existing archive.
    if archive.exists() {
        fs::remove_file(&archive)?;
    }
    // `D` leaves out times and users, which would change the bytes.
    run(build.utility("ar").arg("rcsD").arg(archive).arg(&object))?;
    Ok(fs::remove_file(object)?)
}

/// Merges the sections of each kind into one. Unwinding sections are found by their names.
const SECTIONS: &str = "\
SECTIONS {
    .text : { *(.text .text.*) }
    .rodata : { *(.rodata .rodata.*) }
    .data.rel.ro : { *(.data.rel.ro .data.rel.ro.*) }
    .data : { *(.data .data.*) }
    .bss : { *(.bss .bss.*) }
    .tdata : { *(.tdata .tdata.*) }
    .tbss : { *(.tbss .tbss.*) }
    .gcc_except_table : { *(.gcc_except_table .gcc_except_table.*) }
}
";

/// Makes the shared library under its full name, and symbolic links with the shorter names.
fn put_shared(build: &Build, built: &Path, lib: &Path) -> Result<()> {
    let (major, api) = API;
    let map = built.join("htex.map");
    fs::write(&map, format!("HTEX_{api} {{ global: htex_*; local: *; }};\n"))?;
    let (full, short) = (format!("libhtex.so.{api}"), format!("libhtex.so.{major}"));
    let mut link = build.cc();
    link.args(["-shared", "-s", "-Wl,--gc-sections", "-Wl,-z,relro,-z,now"]);
    link.arg(format!("-Wl,-soname,{short}"));
    link.arg(format!("-Wl,--version-script={}", map.display()));
    link.arg("-Wl,--whole-archive").arg(built.join("libhtex_c.a"));
    link.args(["-Wl,--no-whole-archive", "-lpthread", "-ldl", "-lm"]);
    if build.is_release() {
        // zig has LLVM's unwinder instead of GCC's.
        link.arg("-lunwind");
    }
    run(link.arg("-o").arg(lib.join(&full)))?;
    link_to(&full, &lib.join(&short))?;
    link_to(&short, &lib.join("libhtex.so"))
}

fn put_dylib(built: &Path, lib: &Path) -> Result<()> {
    let (major, api) = API;
    let (full, short) = (format!("libhtex.{api}.dylib"), format!("libhtex.{major}.dylib"));
    copy(&built.join("libhtex_c.dylib"), &lib.join(&full))?;
    link_to(&full, &lib.join(&short))?;
    link_to(&short, &lib.join("libhtex.dylib"))
}

/// Puts the Windows DLL where programs find it, and the import library where compilers find it.
fn put_dll(build: &Build, built: &Path, lib: &Path) -> Result<()> {
    copy(&built.join("htex_c.dll"), &lib.join("htex.dll"))?;
    let definitions = built.join("htex.def");
    fs::write(&definitions, format!("LIBRARY htex.dll\nEXPORTS\n{}\n", functions()?.join("\n")))?;
    let mut import = build.utility("dlltool");
    import.args(["--deterministic-libraries", "-d"]).arg(definitions);
    run(import.arg("-l").arg(lib.join("htex.lib")))
}

/// Returns the names of the functions in the header, sorted.
fn functions() -> Result<Vec<String>> {
    let header = fs::read_to_string(workspace().join("sdk/bindings/capi/include/htex.h"))?;
    let mut names: Vec<String> = header.lines().filter_map(function).map(str::to_owned).collect();
    names.sort();
    names.dedup();
    Ok(names)
}

/// Returns the function that a line of the header declares.
fn function(line: &str) -> Option<&str> {
    let declares = line.starts_with(|first: char| first.is_ascii_lowercase());
    let (before, _) = line.split_once('(').filter(|_| declares)?;
    let name = before.rsplit([' ', '*']).next()?;
    name.starts_with("htex_").then_some(name)
}

/// Makes a symbolic link, replacing whatever is there.
#[cfg(unix)]
fn link_to(to: &str, at: &Path) -> Result<()> {
    match fs::remove_file(at) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(error.into()),
        _ => {}
    }
    fs_err::os::unix::fs::symlink(to, at).context("a link")
}

#[cfg(not(unix))]
fn link_to(to: &str, at: &Path) -> Result<()> {
    let folder = at.parent().context("a link has a folder")?;
    copy(&folder.join(to), at)
}
