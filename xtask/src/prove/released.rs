//! What is released, where nothing of Rust is: in an empty root of Debian, and under Wine.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use fs_err as fs;

use crate::places::{target, workspace};
use crate::programs::{program, run};

/// A library that Wine 8 lacks, of which the standard library of Rust takes random bytes.
const PRIMITIVES: &str = "\
#include <windows.h>
#include <ntsecapi.h>
__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T count)
{
    return RtlGenRandom(bytes, (ULONG)count);
}
";

const CMAKE: &str = "\
cmake_minimum_required(VERSION 3.16)
project(play C)
find_package(htex REQUIRED)
foreach(library htex static whole whole_static)
    add_executable(play_${library} play.c)
    target_link_libraries(play_${library} PRIVATE htex::${library} m)
endforeach()
";

/// Lines of the command that write the same files under Wine and here.
const SAME: [&str; 3] = [
    "simulate --surface vinyl --seconds 4 -o rec.csv",
    "fit rec.csv -o vinyl.htex --name Vinyl --license CC0-1.0",
    "synth vinyl.htex --seconds 1 -o vinyl.wav",
];

/// What is done in the root: first what must not be there.
const SCRIPT: &str = "\
set -eu
for compiler in cc gcc clang rustc cargo; do
    if command -v $compiler; then echo \"this root has $compiler\"; exit 1; fi
done
cd /htex
htex=/htex/NAME/bin/htex
begin() { echo \"released: $1\"; }
begin command
$htex --version
$htex demo out >demo.txt
tail -n 5 demo.txt
$htex simulate --surface vinyl --seconds 4 -o rec.csv
$htex fit rec.csv -o vinyl.htex --name Vinyl --license CC0-1.0 >fit.txt
$htex validate vinyl.htex
$htex synth vinyl.htex --seconds 1 -o built-in.wav
for plugin in /htex/NAME/lib/htex/plugins/*; do
    $htex plugin info $plugin >/dev/null
done
begin C
for play in play_pkg_config play_htex play_static play_whole play_whole_static; do
    LD_LIBRARY_PATH=/htex/NAME/lib ./$play vinyl.htex $play.f32
    cmp $play.f32 play_pkg_config.f32
done
LD_LIBRARY_PATH=/htex/NAME/lib/whole ./play_whole vinyl.htex whole.f32
cmp whole.f32 play_pkg_config.f32
begin Python
python3 -m venv python
python/bin/pip install --quiet --no-index --find-links wheels htex
python/bin/python page.py
begin done
";

/// A page for a user of Python.
const PAGE: &str = "\
import htex
fit = htex.fit('rec.csv', name='Vinyl', license='CC0-1.0')
fit.texture.save('python.htex')
texture = htex.open('python.htex')
voice = texture.voice(seed=7)
voice.set_motion(80.0, 0.4)
samples = voice.render(20000)
print(texture.models, float(samples.std()))
assert samples.std() > 0
";

/// The file of a folder with an ending, and its name without that.
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

/// Uses what is released on an empty root of Debian.
pub(super) fn bare(options: &[&str]) -> Result<()> {
    let released = folder(options)?;
    let (archive, stem) = archive(&released, "-x86_64-linux.tar.xz")?;
    let name = format!("{stem}-x86_64-linux");
    let root = root()?;
    let work = root.join("htex");
    if work.exists() {
        fs::remove_dir_all(&work)?;
    }
    fs::create_dir_all(work.join("wheels"))?;
    run(program("tar", &work).arg("-xf").arg(archive))?;
    programs(&work, &work.join(&name))?;
    let wheel = crate::places::files(&released)?.into_iter();
    let mut wheel = wheel.filter(|file| {
        let file = file.to_string_lossy();
        file.ends_with(".whl") && file.contains("linux") && file.contains("x86_64")
    });
    let wheel = wheel.next_back().context("no wheel for Linux")?;
    // Of the same Python as the root's.
    let mut pip = program("python3", &work);
    pip.args([
        "-m",
        "pip",
        "download",
        "--quiet",
        "--only-binary=:all:",
        "--python-version",
        "3.11",
    ]);
    run(pip.args(["--dest", "wheels"]).arg(wheel))?;
    fs::write(work.join("page.py"), PAGE)?;
    fs::write(work.join("script.sh"), SCRIPT.replace("NAME", &name))?;
    let mut chroot = Command::new("chroot");
    chroot
        .arg(&root)
        .args(["/bin/sh", "/htex/script.sh"])
        .env_clear();
    run(chroot
        .env("PATH", "/usr/sbin:/usr/bin:/bin")
        .env("HOME", "/root")
        .env("LC_ALL", "C.UTF-8"))
}

/// The folder of `--release DIR`.
fn folder(options: &[&str]) -> Result<PathBuf> {
    match *options {
        ["--release", folder] => Ok(fs::canonicalize(folder)?),
        _ => bail!("--release DIR, to which `cargo xtask release --out DIR` wrote"),
    }
}

/// Makes the root.
pub(super) fn bare_root(options: &[&str]) -> Result<()> {
    super::none(options)?;
    root().map(drop)
}

/// A root of Debian 12 with Python and without compilers, made once.
fn root() -> Result<PathBuf> {
    let root = std::path::absolute(target().join("bare-root"))?;
    let is_made = root.join("made");
    if !is_made.exists() {
        let mut debootstrap = Command::new("debootstrap");
        debootstrap.args(["--variant=minbase", "--include=python3-venv", "bookworm"]);
        run(debootstrap.arg(&root).arg("http://deb.debian.org/debian"))
            .context("as root, with the package debootstrap")?;
        fs::write(is_made, "")?;
    }
    Ok(root)
}

/// Builds the player in C against the unpacked archive, by pkg-config and by CMake.
fn programs(work: &Path, prefix: &Path) -> Result<()> {
    let source = workspace().join("sdk/capi/examples/play.c");
    let build = work.join("built");
    fs::create_dir_all(&build)?;
    fs::copy(source, build.join("play.c"))?;
    fs::write(build.join("CMakeLists.txt"), CMAKE)?;
    let line = "cc -std=c11 -Wall -Werror play.c $(pkg-config --cflags --libs htex) -lm -o ../play_pkg_config";
    let mut compile = program("sh", &build);
    compile.args(["-c", line]);
    run(compile.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig")))?;
    let mut configure = program("cmake", &build);
    configure.args([
        "-S",
        ".",
        "-B",
        ".",
        "-DCMAKE_SKIP_RPATH=ON",
        "-DCMAKE_RUNTIME_OUTPUT_DIRECTORY=..",
    ]);
    run(configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display())))?;
    run(program("cmake", &build).args(["--build", "."]))
}

/// Uses what is released for Windows under Wine.
pub(super) fn wine(options: &[&str]) -> Result<()> {
    let released = folder(options)?;
    let (archive, stem) = archive(&released, "-x86_64-windows.zip")?;
    let work = std::path::absolute(target().join("wine"))?;
    if work.exists() {
        fs::remove_dir_all(&work)?;
    }
    fs::create_dir_all(&work)?;
    run(program("python3", &work)
        .args(["-m", "zipfile", "-e"])
        .arg(archive)
        .arg("."))?;
    let prefix = work.join(format!("{stem}-x86_64-windows"));
    fs::write(work.join("primitives.c"), PRIMITIVES)?;
    let bin = prefix.join("bin");
    let gcc = || program("x86_64-w64-mingw32-gcc", &work);
    run(gcc()
        .args(["-shared", "-O", "primitives.c", "-ladvapi32", "-o"])
        .arg(bin.join("bcryptprimitives.dll")))
    .context("the package gcc-mingw-w64-x86-64")?;
    let play = workspace().join("sdk/capi/examples/play.c");
    let mut compile = gcc();
    compile
        .args(["-std=c11", "-Wall", "-Werror", "-I"])
        .arg(prefix.join("include"))
        .arg(play);
    run(compile
        .arg(prefix.join("lib/htex.lib"))
        .arg("-o")
        .arg(bin.join("play.exe")))?;
    fs::copy(prefix.join("lib/htex.dll"), bin.join("htex.dll"))?;
    let wine = |name: &str, line: &str| {
        let mut wine = program("wine", &work);
        wine.arg(bin.join(name)).args(line.split_whitespace());
        run(wine
            .env("WINEDEBUG", "-all")
            .env("WINEPREFIX", work.join("prefix")))
        .context("the package wine64")
    };
    wine("htex.exe", "--version")?;
    for line in SAME {
        wine("htex.exe", line)?;
    }
    wine("htex.exe", "validate vinyl.htex")?;
    wine("play.exe", "vinyl.htex play.f32")?;
    same_here(&work)
}

/// The command of this machine writes the same recording, asset and samples.
fn same_here(work: &Path) -> Result<()> {
    let here = work.join("here");
    fs::create_dir_all(&here)?;
    for line in SAME {
        let mut htex = Command::new(crate::places::cargo());
        let manifest = fs::canonicalize(workspace().join("Cargo.toml"))?;
        htex.args([
            "run",
            "--quiet",
            "--locked",
            "--package",
            "htex-cli",
            "--manifest-path",
        ]);
        htex.arg(manifest).arg("--").args(line.split_whitespace());
        run(htex.current_dir(&here))?;
    }
    for name in ["rec.csv", "vinyl.htex", "vinyl.wav"] {
        let is_same = fs::read(here.join(name))? == fs::read(work.join(name))?;
        ensure!(is_same, "{name} of Windows is not that of this machine");
    }
    eprintln!(
        "released: the recording, the asset and the samples of Windows are those of this machine"
    );
    Ok(())
}
