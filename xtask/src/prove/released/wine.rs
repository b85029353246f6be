//! Tests the Windows release under Wine.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use fs_err as fs;

use super::{Compiler, Folder, archive};
use crate::places::{cargo, emptied, target, workspace};
use crate::programs::{program, run};

const COMPILER: Compiler = Compiler {
    gcc: "x86_64-w64-mingw32-gcc",
    package: "gcc-mingw-w64-x86-64",
    system: "Windows",
    processor: "AMD64",
    libraries: "htex whole",
};

/// The source of a library that Wine 8 lacks. Rust's standard library gets random bytes from this
/// library.
const PRIMITIVES: &str = "\
#include <windows.h>
#include <ntsecapi.h>
__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T count)
{
    return RtlGenRandom(bytes, (ULONG)count);
}
";

/// Command lines that must write the same files under Wine and on this machine.
const SAME: [&str; 3] = [
    "simulate --surface vinyl --seconds 4 -o rec.csv",
    "fit rec.csv -o vinyl.htex --name Vinyl --license CC0-1.0",
    "synth vinyl.htex --seconds 1 -o built-in.wav",
];

/// The C players, and the folder from which each player's library is copied next to it.
const PLAYERS: [(&str, &str); 3] =
    [("play_pkg_config", "lib"), ("play_htex", "lib"), ("play_whole", "lib/whole")];

/// Tests the Windows release under Wine.
pub(in crate::prove) fn wine(options: &Folder) -> Result<()> {
    let released = options.released()?;
    let (archive, stem) = archive(&released, "-x86_64-windows.zip")?;
    let work = std::path::absolute(target().join("wine"))?;
    emptied(&work)?;
    run(program("python3", &work).args(["-m", "zipfile", "-e"]).arg(archive).arg("."))?;
    let prefix = work.join(format!("{stem}-x86_64-windows"));
    // Built in the working folder, where Windows also looks for libraries.
    fs::write(work.join("primitives.c"), PRIMITIVES)?;
    run(program(COMPILER.gcc, &work).args([
        "-shared",
        "-O",
        "primitives.c",
        "-ladvapi32",
        "-o",
        "bcryptprimitives.dll",
    ]))
    .context("the package gcc-mingw-w64-x86-64")?;
    COMPILER.players(&prefix, &work)?;
    let htex = prefix.join("bin/htex.exe");
    wine_runs(&work, &htex, "--version")?;
    wine_runs(&work, &htex, "demo out")?;
    for line in SAME {
        wine_runs(&work, &htex, line)?;
    }
    wine_runs(&work, &htex, "validate vinyl.htex")?;
    for (name, library) in PLAYERS {
        let folder = work.join(name);
        fs::create_dir_all(&folder)?;
        fs::copy(prefix.join(library).join("htex.dll"), folder.join("htex.dll"))?;
        let player = folder.join(format!("{name}.exe"));
        fs::rename(work.join(format!("{name}.exe")), &player)?;
        wine_runs(&work, &player, &format!("vinyl.htex {name}.f32"))?;
        let is_same = read(&work, &format!("{name}.f32"))? == read(&work, "play_pkg_config.f32")?;
        ensure!(is_same, "{name} plays other samples than play_pkg_config");
    }
    same_here(&work)?;
    run(program("sha256sum", &work).args([
        "rec.csv",
        "vinyl.htex",
        "built-in.wav",
        "play_pkg_config.f32",
    ]))
}

fn read(folder: &Path, name: &str) -> Result<Vec<u8>> {
    Ok(fs::read(folder.join(name))?)
}

/// Runs a Windows program.
fn wine_runs(work: &Path, exe: &Path, line: &str) -> Result<()> {
    let mut wine = program("wine", work);
    wine.arg(exe).args(line.split_whitespace());
    run(wine.env("WINEDEBUG", "-all").env("WINEPREFIX", work.join("prefix")))
        .context("the package wine64")
}

/// Tests that this machine's command writes the same recording, asset and samples.
fn same_here(work: &Path) -> Result<()> {
    let here = work.join("here");
    fs::create_dir_all(&here)?;
    for line in SAME {
        let mut htex = Command::new(cargo());
        let manifest = fs::canonicalize(workspace().join("Cargo.toml"))?;
        htex.args(["run", "--quiet", "--locked", "--profile", "quick"]);
        htex.args(["--package", "htex-cli", "--manifest-path"]);
        htex.arg(manifest).arg("--").args(line.split_whitespace());
        run(htex.current_dir(&here))?;
    }
    for name in ["rec.csv", "vinyl.htex", "built-in.wav"] {
        let is_same = read(&here, name)? == read(work, name)?;
        ensure!(is_same, "{name} differs between Windows and this machine");
    }
    eprintln!("released: Windows and this machine give the same recording, asset and samples");
    Ok(())
}
