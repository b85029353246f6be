//! Tests the installed libhtex: pkg-config, CMake, the static libraries, SDL2, the FMOD plugin, and
//! the sizes.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};

use crate::dist::{Dist, dist};
use crate::places::{cargo, workspace};
use crate::platform::Build;
use crate::programs::{program, run};

/// Largest size of the small shared library, bytes. The goal is 1.5 MB; docs/languages.md says what
/// takes up the rest.
const SMALL: u64 = 2_500_000;

/// Largest sizes of the small and the whole static library, bytes.
const STATIC: u64 = 25_000_000;
const WHOLE_STATIC: u64 = 46_000_000;

const CMAKE: &str = "cmake_minimum_required(VERSION 3.16)\nproject(app C)\nfind_package(htex @LINE@ REQUIRED)\n\
                     find_package(htex 0.0 QUIET)\nif(htex_FOUND)\n    message(FATAL_ERROR \"of another line of versions\")\nendif()\n\
                     foreach(library htex static whole whole_static)\n    add_executable(app_${library} main.c)\n    \
                     target_link_libraries(app_${library} PRIVATE htex::${library} m)\nendforeach()\n";

/// The ways in which users build a player of assets: the player's name, and the end of the
/// compiler's command line.
const LINES: [(&str, &str); 7] = [
    ("small", "main.c $(pkg-config --cflags --libs htex) -lm"),
    ("whole", "main.c $(pkg-config --cflags --libs htex-whole) -lm"),
    ("static", "main.c -static $(pkg-config --static --cflags --libs htex)"),
    ("whole-static", "main.c -static $(pkg-config --static --cflags --libs htex-whole)"),
    ("two", "two.c libother.a -static $(pkg-config --static --cflags --libs htex)"),
    // If both libraries contain the same name, the linker takes it from the first library.
    ("two-after", "two.c -I prefix/include prefix/lib/libhtex.a libother.a -lpthread -ldl -lm"),
    (
        "two-whole-after",
        "two.c -I prefix/include prefix/lib/whole/libhtex.a libother.a -lpthread -ldl -lm",
    ),
];

/// The player that also calls another static Rust library.
const TWO: &str = "\
#define main play
#include \"main.c\"
#undef main
double other_sum(const double *numbers, size_t count);
int main(int argc, char **argv)
{
    const double numbers[] = {1.0, 2.0};
    if (other_sum(numbers, 2) != 3.0 || other_sum(numbers, 0) != -1.0)
        return 3;
    return play(argc, argv);
}
";

/// The source of a Rust library without htex. It panics if it gets no numbers, and catches this
/// panic.
const OTHER: &str = "\
#[unsafe(no_mangle)]
pub extern \"C\" fn other_sum(numbers: *const f64, count: usize) -> f64 {
    // SAFETY: the caller has that many numbers.
    let numbers = unsafe { std::slice::from_raw_parts(numbers, count) };
    let sum = std::panic::catch_unwind(|| numbers[0] + numbers[1..].iter().sum::<f64>());
    sum.unwrap_or(-1.0)
}
";

struct Installation {
    folder: PathBuf,
    prefix: PathBuf,
    asset: PathBuf,
}

pub(super) fn test(folder: &Path) -> Result<()> {
    let folder = fs_err::canonicalize(folder)?;
    let capi = fs_err::canonicalize(workspace().join("sdk/bindings/capi"))?;
    let installed = Installation {
        asset: capi.join("../../../examples/scenes/vinyl.htex"),
        prefix: folder.join("prefix"),
        folder: folder.clone(),
    };
    dist(&Dist { prefix: installed.prefix.clone(), whole: true, build: Build::here()? })?;
    fs_err::copy(capi.join("examples/play.c"), folder.join("main.c"))?;
    fs_err::write(folder.join("two.c"), TWO)?;
    other(&folder)?;
    let mut samples = Vec::new();
    for (name, line) in LINES {
        let words = format!("cc -std=c11 -Wall -Werror {line} -o play-{name}");
        run(&mut installed.shell(&words))?;
        samples.push(installed.played(&format!("play-{name}"))?);
    }
    let version = crate::places::version()?;
    let line = version.rsplit_once('.').map_or("", |(line, _)| line);
    fs_err::write(folder.join("CMakeLists.txt"), CMAKE.replace("@LINE@", line))?;
    let mut configure = program("cmake", &folder);
    configure.args(["-S", ".", "-B", "built"]);
    run(configure.arg(format!("-DCMAKE_PREFIX_PATH={}", installed.prefix.display())))?;
    run(program("cmake", &folder).args(["--build", "built"]))?;
    for name in ["htex", "static", "whole", "whole_static"] {
        samples.push(installed.played(&format!("built/app_{name}"))?);
    }
    // `play.c` renders 625 blocks of 64 samples of four bytes.
    let is_whole = samples[0].len() == 4 * 64 * 625;
    ensure!(
        is_whole && samples.windows(2).all(|pair| pair[0] == pair[1]),
        "the builds render different samples"
    );
    examples(&installed, &capi)?;
    fmod(&installed, &capi)?;
    names(&installed)?;
    stacks(&installed.prefix.join("lib"))?;
    sizes(&installed.prefix.join("lib"))
}

/// Builds the library [`OTHER`].
fn other(folder: &Path) -> Result<()> {
    fs_err::write(folder.join("other.rs"), OTHER)?;
    let rustc = Path::new(&cargo()).with_file_name("rustc");
    let rustc = if rustc.exists() { rustc } else { "rustc".into() };
    run(program(rustc, folder).args(["--crate-type", "staticlib", "-O", "other.rs"]))
}

/// Tests that the installed library allocates nothing in real-time calls, and plays its samples
/// with SDL 2.
fn examples(installed: &Installation, capi: &Path) -> Result<()> {
    let real_time = capi.join("tests/hosts/real_time.c");
    let flags = "$(pkg-config --cflags --libs htex-whole) -lm";
    run(&mut installed.shell(&format!(
        "cc -std=c11 -O1 -Wall -Werror -DCOUNTED -pthread {} {flags} -o real_time",
        real_time.display()
    )))?;
    run(installed.program("real_time").arg(&installed.asset).arg("20000"))?;
    let sdl = capi.join("examples/play_sdl.c");
    run(&mut installed.shell(&format!(
        "cc -std=c11 -Wall -Werror {} $(pkg-config --cflags --libs htex-whole sdl2) -lm -o play_sdl",
        sdl.display()
    )))?;
    let mut play = installed.program("play_sdl");
    play.arg(&installed.asset).arg("1");
    // No sound card is needed.
    run(play.env("SDL_AUDIODRIVER", "dummy"))
}

/// Tests that the FMOD plugin contains the static library and exports only its own names. A test
/// host that stands in for FMOD plays the plugin.
fn fmod(installed: &Installation, capi: &Path) -> Result<()> {
    let tests = capi.join("tests");
    let (prefix, headers) = (installed.prefix.display(), tests.join("fmod"));
    run(program("cmake", &installed.folder)
        .args(["-S", "prefix/share/htex/fmod", "-B", "fmod"])
        .arg(format!("-DFMOD_ROOT={}", headers.display()))
        .arg(format!("-DCMAKE_PREFIX_PATH={prefix}")))?;
    run(program("cmake", &installed.folder).args(["--build", "fmod"]))?;
    run(&mut installed.shell(&format!(
        "cc -std=c11 -O1 -Wall -Werror -DCOUNTED -I{} -I{} {} -o host",
        headers.display(),
        tests.join("hosts").display(),
        headers.join("host.c").display()
    )))?;
    let mut host = installed.program("host");
    host.arg("fmod/libhtex_fmod.so").arg(&installed.asset);
    run(host.args(["512", "fmod.f32", "20", "7", "80,0.4", "0,0.4"]))?;
    let names = "test \"$(nm -D --defined-only fmod/libhtex_fmod.so | cut -d' ' -f3)\" = FMODGetDSPDescription";
    run(&mut installed.shell(names))
}

/// Tests that the libraries export only the names in the header, and that these names have a
/// version in the shared libraries.
fn names(installed: &Installation) -> Result<()> {
    for folder in ["lib", "lib/whole"] {
        let lib = installed.prefix.join(folder);
        for (file, flags) in [("libhtex.a", "-g"), ("libhtex.so", "-D")] {
            let line = format!("nm --defined-only {flags} {}", lib.join(file).display());
            let mut nm = installed.shell(&line);
            let output = nm.output()?;
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            let names: Vec<&str> = text.lines().filter_map(|line| line.split(' ').nth(2)).collect();
            let is_ours = |name: &&str| match file {
                "libhtex.a" => name.starts_with("htex_"),
                // The version itself is also listed as a name.
                _ => name.ends_with("@@HTEX_1.0") || *name == "HTEX_1.0",
            };
            let strange: Vec<_> = names.iter().filter(|name| !is_ours(name)).collect();
            ensure!(names.len() > 50, "{folder}/{file} has {} names", names.len());
            ensure!(strange.is_empty(), "{folder}/{file} has the names {strange:?}");
        }
    }
    Ok(())
}

/// Tests that a program that links the static libraries has no executable stack.
fn stacks(lib: &Path) -> Result<()> {
    for file in ["libhtex.a", "whole/libhtex.a"] {
        let mut sections = program("readelf", lib);
        let output = sections.args(["-SW", file]).output()?;
        let says_so = String::from_utf8_lossy(&output.stdout).contains(".note.GNU-stack");
        ensure!(says_so, "{file} does not say that its stack holds no code");
    }
    Ok(())
}

/// Prints the sizes of the libraries, and tests that they are within the limits.
fn sizes(lib: &Path) -> Result<()> {
    let most = [
        ("libhtex.so", SMALL),
        ("libhtex.a", STATIC),
        ("whole/libhtex.so", u64::MAX),
        ("whole/libhtex.a", WHOLE_STATIC),
    ];
    for (file, most) in most {
        let bytes = fs_err::metadata(lib.join(file))?.len();
        eprintln!("bindings: lib/{file}: {bytes} bytes");
        ensure!(bytes <= most, "{file}: {bytes} bytes; at most {most}");
    }
    Ok(())
}

impl Installation {
    /// Returns a shell command that finds the library through pkg-config.
    fn shell(&self, line: &str) -> std::process::Command {
        let mut shell = program("sh", &self.folder);
        shell.args(["-c", line]);
        shell.env("PKG_CONFIG_PATH", self.prefix.join("lib/pkgconfig"));
        shell
    }

    /// Returns a command for a built program. It finds the whole library if its name contains
    /// `whole`.
    fn program(&self, name: &str) -> std::process::Command {
        let is_small = ["play-small", "built/app_htex"].contains(&name);
        let lib = if is_small { "lib" } else { "lib/whole" };
        let mut program = program(self.folder.join(name), &self.folder);
        program.env("LD_LIBRARY_PATH", self.prefix.join(lib));
        program
    }

    /// Returns the samples that a built player writes.
    fn played(&self, name: &str) -> Result<Vec<u8>> {
        let out = self.folder.join("played.f32");
        run(self.program(name).arg(&self.asset).arg(&out))?;
        Ok(fs_err::read(out)?)
    }
}
