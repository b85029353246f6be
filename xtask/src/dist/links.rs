//! The libraries themselves, which have no names but those of the header.
//!
//! Cargo's static library has the names of the standard library of Rust and of all dependencies,
//! and no two such libraries link in one program ("multiple definition of rust_eh_personality"). So
//! its objects are linked to one, what no function of the header reaches is dropped, and all other
//! names are made local. The shared library is linked of the same objects, with a version of its
//! names.

use std::path::Path;

use anyhow::{Context, Result};
use fs_err as fs;

use super::copy;
use crate::places::workspace;
use crate::platform::{Build, System};
use crate::programs::run;

/// The version of the interface, `HTEX_API_VERSION`: its major number is that of the shared
/// library, both are the version of its names.
const API: (&str, &str) = ("1", "1.0");

/// Puts the libraries of a built folder into `lib`. `is_merged`: the static library has one section
/// of each kind, half the bytes where there are a hundred thousand functions; a program then links
/// all of it or nothing.
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

/// The static library of one object.
fn put_static(build: &Build, built: &Path, lib: &Path, is_merged: bool) -> Result<()> {
    let object = built.join("htex.o");
    let mut link = build.utility("ld");
    // Without groups: a linker keeps one of each name, and what refers to another library's would
    // have a name that is local here.
    link.args(["-r", "--gc-sections", "--force-group-allocation"]);
    for name in functions()?.iter().filter(|name| !name.ends_with("_wide")) {
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
    // What a compiler embeds for link-time optimisation, where it is not dropped already.
    let mut localise = build.utility("objcopy");
    localise.args(["--wildcard", "--keep-global-symbol=htex_*"]);
    localise.args(["--strip-debug", "-R", ".llvmbc", "-R", ".llvmcmd"]);
    run(localise.args(["-R", ".comment"]).arg(&object))?;
    run(build.utility("objcopy").arg("--strip-unneeded").arg(&object))?;
    let archive = lib.join("libhtex.a");
    if archive.exists() {
        fs::remove_file(&archive)?;
    }
    run(build.utility("ar").arg("rcsD").arg(archive).arg(&object))?;
    Ok(fs::remove_file(object)?)
}

/// Sections of a kind in one; those for unwinding are found by their names.
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

/// The shared library under its full name, with links of the shorter ones.
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

/// The library of Windows beside the programs that load it, and what compilers link against.
fn put_dll(build: &Build, built: &Path, lib: &Path) -> Result<()> {
    copy(&built.join("htex_c.dll"), &lib.join("htex.dll"))?;
    let definitions = built.join("htex.def");
    fs::write(&definitions, format!("LIBRARY htex.dll\nEXPORTS\n{}\n", functions()?.join("\n")))?;
    let mut import = build.utility("dlltool");
    import.args(["--deterministic-libraries", "-d"]).arg(definitions);
    run(import.arg("-l").arg(lib.join("htex.lib")))
}

/// The functions of the header.
fn functions() -> Result<Vec<String>> {
    let header = fs::read_to_string(workspace().join("sdk/capi/include/htex.h"))?;
    let mut names: Vec<String> = header.lines().filter_map(function).map(str::to_owned).collect();
    names.sort();
    names.dedup();
    Ok(names)
}

/// The function that a line of the header declares.
fn function(line: &str) -> Option<&str> {
    let declares = line.starts_with(|first: char| first.is_ascii_lowercase());
    let (before, _) = line.split_once('(').filter(|_| declares)?;
    let name = before.rsplit([' ', '*']).next()?;
    name.starts_with("htex_").then_some(name)
}

/// A symbolic link in place of whatever is there.
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
