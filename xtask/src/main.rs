//! Tasks of developers: `cargo xtask`.

use std::process::{Command, ExitCode};

use anyhow::Result;
use xtask::dist::{Dist, dist};
use xtask::platform::Build;
use xtask::programs::run;
use xtask::{fuzz, plugins};

const TASKS: &str = "\
cargo xtask ci        runs all steps of continuous integration
cargo xtask plugins   builds the models as plugins into target/htex-plugins, native and WASM;
                      --native-only or --wasm-only builds the one kind; --wasm-toolchain WAY (or
                      HTEX_WASM_TOOLCHAIN) builds modules with the toolchain that is installed, with debian's own
                      compiler, or auto: the first that is there
cargo xtask bench     measures htex beside plain loops in C and NumPy, SciPy, librosa, in one run;
                      --json FILE writes the numbers too
cargo xtask fuzz      fuzzes the TARGETS named, or all of fuzz/fuzz_targets, each for --seconds N (60)
                      or --executions N, --jobs N (2) at a time; with --address under the address
                      sanitizer, which needs a nightly toolchain; see fuzz/README.md
cargo xtask dist --prefix DIR [--whole]  builds and installs libhtex for C, C++ and C#: the small library and, with --whole, in
                      lib/whole the one with scenes, libraries and the engine of WASM modules
cargo xtask release --out DIR [--only NAME,…] [--trial]  builds archives, wheels and the npm package, of all platforms or those named:
                      linux-x86_64, linux-aarch64, windows-x86_64, macos, npm, sdist; --trial: by this machine's tools, for this
                      machine, without lists of licences and parts
cargo xtask book --out DIR  makes a book of HTML of the pages of docs and spec, by mdBook, and follows its links
cargo xtask firmware --out DIR  lays out the player in C for Arduino, ESP-IDF and Zephyr
cargo xtask bindings  tests the bindings to other languages and on other processors, all or those named: c, web, studio,
                      python, processors; says what is missing
cargo xtask web --out DIR  builds the npm package `htex` for browsers and Node.js
cargo xtask studio --out DIR  builds the studio: DIR/studio.html, one file, and DIR/static, for a web server
cargo xtask studio-shelf  makes the textures that come with the studio anew, sdk/studio/shelf/shelf.htexlib
cargo xtask prove [NAME]  runs a proof that takes long; lists them without a name
cargo xtask generate  writes the generated files of spec/: schemas, pages, conformance files; and
                      the seeds of the fuzz targets";

fn main() -> Result<ExitCode> {
    let tasks: Vec<String> = std::env::args().skip(1).collect();
    match tasks.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["plugins", ref options @ ..] => return build_plugins(options),
        ["bench", ref options @ ..] => xtask::bench::bench(options)?,
        ["fuzz", ref options @ ..] => match fuzz::Options::parse(options) {
            Ok(options) => fuzz::fuzz(&options)?,
            Err(error) => return Ok(usage(&format!("{error}\n"))),
        },
        ["dist", "--prefix", prefix] => install(prefix, false)?,
        ["dist", "--prefix", prefix, "--whole"] | ["dist", "--whole", "--prefix", prefix] => {
            install(prefix, true)?;
        }
        ["release", ref words @ ..] => {
            xtask::release::release(&xtask::release::Release::parse(words)?)?
        }
        ["book", "--out", out] => xtask::book::book(out.as_ref())?,
        ["firmware", "--out", out] => xtask::firmware::firmware(out.as_ref())?,
        ["bindings", ref names @ ..] => xtask::bindings::test(names)?,
        ["prove", ref arguments @ ..] => xtask::prove::prove(arguments)?,
        ["web", "--out", out] => xtask::web::web(out.as_ref())?,
        ["studio", "--out", out] => xtask::studio::studio(out.as_ref())?,
        ["studio-shelf"] => xtask::shelf::shelf()?,
        ["ci"] => {
            let workspace = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
            run(Command::new("bash").arg(".ci/run").current_dir(workspace))?;
        }
        ["generate"] => xtask::generated::generate()?,
        _ => return Ok(usage("")),
    }
    Ok(ExitCode::SUCCESS)
}

/// Prints what is wrong and the tasks.
fn usage(problem: &str) -> ExitCode {
    eprintln!("{problem}{TASKS}");
    ExitCode::from(2)
}

/// Builds the models as the options say, and prints their folder.
fn build_plugins(options: &[&str]) -> Result<ExitCode> {
    let (options, way) = match options {
        [rest @ .., "--wasm-toolchain", way] => (rest, Some(*way)),
        ["--wasm-toolchain", way, rest @ ..] => (rest, Some(*way)),
        all => (all, None),
    };
    if let Some(Err(error)) = way.map(plugins::check_way) {
        return Ok(usage(&format!("{error}\n")));
    }
    let wasm = || way.map_or_else(plugins::wasm, plugins::wasm_by);
    let folder = match options {
        [] => plugins::native().and_then(|_| wasm())?,
        ["--native-only"] if way.is_none() => plugins::native()?,
        ["--wasm-only"] => wasm()?,
        _ => return Ok(usage("")),
    };
    println!("{}", folder.display());
    Ok(ExitCode::SUCCESS)
}

/// Installs libhtex.
fn install(prefix: &str, whole: bool) -> Result<()> {
    dist(&Dist { prefix: prefix.into(), whole, build: Build::here()? })
}
